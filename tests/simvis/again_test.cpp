// run.json holds all that a run depends on: from it alone the same bytes are made again.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string_view>

#include "engine/base/sha256.h"
#include "tests/support/simvis_run.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kRepeatedSensors = R"(
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="31" min_angle="-60" max_angle="60"
        range_noise="0.01"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="16" height="12" outputs="color depth" read_noise_e="5"/>
<sensor type="psd" name="OFF" insert_at="ROOT"/>)";

/// A folder like a clone of a project: programs run in it, and all names are relative to it.
struct Project {
  TemporaryFolder folder;
  Project() {
    write_wall_scene(folder.path(), kRepeatedSensors);
    write_text(folder / "drive.csv", "time_s,MOVE.x\n0,0\n1,1\n");
  }
  ProcessResult run(const std::string& arguments) const {
    return Process({"/bin/sh", "-c", "cd \"$0\" && exec " + simvis_run() + " " + arguments, folder.path().string()})
        .wait();
  }
};

TEST_CASE("a run made again in another copy of its files has the same bytes") {
  const Project first, second;
  REQUIRE(first
              .run("scene.xml --frames 4 --rate 10 --seed 5 --trajectory drive.csv --set MOVE.y=-1 --sensor SCAN "
                   "--sensor CAM --method planar --format csv,ply --poses WALL --threads 1 --quiet")
              .exit_code == 0);
  const auto json = nlohmann::json::parse(read_text(first.folder / "out/run.json"));
  CHECK(json["set"] == nlohmann::json{"MOVE.y=-1"});
  CHECK(json["trajectory"]["file"] == "drive.csv");
  CHECK(json["trajectory"]["sha256"] == sha256_of(first.folder / "drive.csv"));
  CHECK(json["inputs"].size() == 3);
  for (const char* input : {"scene.xml", "wall.gltf", "drive.csv"}) {
    CHECK(json["inputs"][input] == sha256_of(first.folder / input));
  }
  CHECK(json["sensors"]["SCAN"]["attributes"]["method"] == "planar");
  CHECK(json["sensors"]["SCAN"]["defaults"]["range_max"] == "80");
  CHECK(json["sensors"]["OFF"]["enabled"] == false);
  CHECK(json["warnings"].empty());
  CHECK(json["host"]["threads"].get<int>() > 0);

  fs::copy(first.folder / "out/run.json", second.folder / "the_run.json");
  const ProcessResult again = second.run("--again the_run.json --out again --quiet");
  INFO(again.err);
  REQUIRE(again.exit_code == 0);
  CHECK(again.err == "");
  const Strings files = files_below(first.folder / "out");
  CHECK(files == files_below(second.folder / "again"));
  CHECK(files.size() > 20);
  for (const std::string& file : files) {
    if (file == "run.json") continue;
    CHECK_MESSAGE(read_text(first.folder / ("out/" + file)) == read_text(second.folder / ("again/" + file)), file);
  }
  // And once more from the report of the second run.
  REQUIRE(second.run("--again again/run.json --out third --quiet").exit_code == 0);
  CHECK(read_text(second.folder / "third/SCAN.csv") == read_text(first.folder / "out/SCAN.csv"));
}

TEST_CASE("a run is made again with the environment variables that led to its files") {
  const Project project;
  fs::create_directories(project.folder / "packages/share/shapes");
  write_text(project.folder / "packages/share/shapes/package.xml", "<package><name>shapes</name></package>");
  write_text(project.folder / "packages/share/shapes/wall.obj", "v 3 -1 -1\nv 3 1 -1\nv 3 0 1\nf 1 2 3\n");
  fs::create_directories(project.folder / "deep/in/folders/of/a/robot");
  write_text(project.folder / "deep/in/folders/of/a/robot/r.urdf",
             "<robot name='r'><link name='a'><visual><geometry><mesh filename='package://shapes/wall.obj'/></geometry>"
             "</visual></link></robot>");
  write_text(project.folder / "scene.xml",
             "<simvis><part file='deep/in/folders/of/a/robot/r.urdf' name='R' insert_at='ROOT'/>"
             "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='5'/></simvis>");
  const std::string packages = (project.folder / "packages").string();
  const auto in = [&](const std::string& variables, const std::string& arguments) {
    return Process({"/bin/sh", "-c", "cd \"$0\" && exec env " + variables + " " + simvis_run() + " " + arguments,
                    project.folder.path().string()})
        .wait()
        .exit_code;
  };
  REQUIRE(in("-u ROS_PACKAGE_PATH AMENT_PREFIX_PATH=" + packages, "--quiet --strict scene.xml") == 0);
  const auto environment = nlohmann::json::parse(read_text(project.folder / "out/run.json"))["environment"];
  CHECK(environment["AMENT_PREFIX_PATH"] == packages);
  REQUIRE(environment.contains("ROS_PACKAGE_PATH"));
  CHECK(environment["ROS_PACKAGE_PATH"].is_null());
  CHECK_FALSE(environment.contains("HOME"));
  CHECK(in("-u AMENT_PREFIX_PATH", "--quiet --out other scene.xml") != 0);
  CHECK(in("ROS_PACKAGE_PATH=/nowhere AMENT_PREFIX_PATH=/nowhere", "--quiet --again out/run.json --out again") == 0);
  CHECK(read_text(project.folder / "out/SCAN.csv") == read_text(project.folder / "again/SCAN.csv"));
}

TEST_CASE("a run is not made again from other files, and not with other options") {
  const Project project;
  REQUIRE(project.run("scene.xml --quiet").exit_code == 0);
  std::ofstream(project.folder / "wall.gltf", std::ios::app) << "\n";
  const ProcessResult changed = project.run("--again out/run.json --out again");
  CHECK(changed.exit_code == 2);
  CHECK(changed.err.find("--again: wall.gltf: error: has changed: its SHA-256 is ") != std::string::npos);
  CHECK_FALSE(fs::exists(project.folder / "again"));
  fs::remove(project.folder / "wall.gltf");
  CHECK(project.run("--again out/run.json").err.find("wall.gltf: error: there is no such file") != std::string::npos);
  const ProcessResult fixed = project.run("--again out/run.json --seed 3");
  CHECK(fixed.exit_code == 2);
  CHECK(fixed.err.find("--again: --seed is fixed by the run") != std::string::npos);
  write_text(project.folder / "other.json", R"({"versions": {}})");
  const ProcessResult other = project.run("--again other.json");
  CHECK(other.exit_code == 2);
  CHECK(other.err.find("other.json: error: is no report of a run") != std::string::npos);
  // A run.json of another program is not taken for results.
  write_text(project.folder / "taken/run.json", "");
  fs::create_directory(project.folder / "taken");
  write_text(project.folder / "taken/run.json", "{}");
  write_wall_scene(project.folder.path(), kRepeatedSensors);
  CHECK(project.run("scene.xml --out taken").exit_code == 2);
  CHECK(read_text(project.folder / "taken/run.json") == "{}");
}

/// The report of a run of this project, changed by `edit`, in its place.
void edit_report(const Project& project, const std::function<void(nlohmann::ordered_json&)>& edit) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(read_text(project.folder / "out/run.json"));
  edit(json);
  write_text(project.folder / "out/run.json", json.dump());
}

// --resume goes on with the run in `out`, which ended before its last frame.
const Strings kOfReport = {"--again out/run.json --out again --quiet", "--resume --frames 3 --quiet"};

TEST_CASE("a report sets no variables but those that lead to packages") {
  const Project project;
  for (const std::string& options : kOfReport) {
    CAPTURE(options);
    REQUIRE(project.run("scene.xml --quiet").exit_code == 0);
    edit_report(project, [](auto& json) {
      json["environment"] = {{"SIMVIS_PYTHON", "/elsewhere/python"},
                             {"VK_ICD_FILENAMES", "/elsewhere/driver.json"},
                             {"VK_DRIVER_FILES", "/elsewhere/driver.json"},
                             {"PATH", nullptr},
                             {"LD_PRELOAD", "/elsewhere/code.so"}};
    });
    const ProcessResult result = project.run(options);
    INFO(result.err);
    CHECK(result.exit_code == 0);  // with another driver there is no device
    for (const char* name : {"SIMVIS_PYTHON", "VK_ICD_FILENAMES", "VK_DRIVER_FILES", "PATH", "LD_PRELOAD"}) {
      CHECK(result.err.find("warning: out/run.json: the recorded environment variable \"" + std::string(name) +
                            "\" is ignored") != std::string::npos);
    }
  }
}

TEST_CASE("a plug-in is loaded when the user names it, not because a report does") {
  const Project project;
  const std::string plugin = tested_build() + "/lib/libsimvis_example_plugin.so";
  for (const std::string& options : kOfReport) {
    CAPTURE(options);
    REQUIRE(project.run("scene.xml --quiet").exit_code == 0);
    CHECK(project.run(options + " --plugin " + plugin).err.find("has not loaded") != std::string::npos);
    edit_report(project, [&](auto& json) {
      json["command"].push_back("--plugin");
      json["command"].push_back(plugin);
    });
    const ProcessResult refused = project.run(options);
    CHECK(refused.exit_code == 2);
    CHECK(refused.err.find("out/run.json: error: the run loaded the plug-in \"" + plugin + "\", which is code") !=
          std::string::npos);
    fs::remove_all(project.folder / "out");
    REQUIRE(project.run("scene.xml --quiet --plugin " + plugin).exit_code == 0);
    const ProcessResult named = project.run(options + " --plugin " + plugin);
    INFO(named.err);
    CHECK(named.exit_code == 0);
    fs::remove_all(project.folder / "out");
  }
}

TEST_CASE("what is no report of a run is refused at once, whatever it is") {
  const Project project;
  REQUIRE(::mkfifo((project.folder / "fifo").c_str(), 0600) == 0);
  fs::create_directory(project.folder / "directory");
  write_text(project.folder / "huge", "{");
  fs::resize_file(project.folder / "huge", std::uintmax_t{1} << 40);  // a hole
  write_text(project.folder / "empty", "");
  write_text(project.folder / "deep", R"({"versions": {"simvis": "1"}, "scene": )" + std::string(2'000'000, '['));
  write_text(project.folder / "name", R"({"versions": {"simvis": "1"}, "command": ["scene.xml\u0000x"]})");
  write_text(project.folder / "kind", R"({"versions": {"simvis": "1"}, "command": "scene.xml"})");
  // A reader that takes /dev/zero for a report fills the memory. The sanitizers need all addresses.
  const std::string limit = sanitized() ? "" : "ulimit -v 8000000; ";
  for (const std::string report : {"/dev/zero", "/dev/null", "fifo", "directory", "huge", "empty", "deep", "name",
                                   "kind", "/proc/self/environ", "/proc/self/mem", "/proc/kcore", "none"}) {
    CAPTURE(report);
    const ProcessResult result =
        Process({"/bin/sh", "-c", limit + "cd \"$0\" && exec " + simvis_run() + " --again " + report + " --out again",
                 project.folder.path().string()})
            .wait(std::chrono::seconds(60));
    CHECK_FALSE(result.timed_out);
    CHECK(result.exit_code == 2);
    CHECK_MESSAGE(result.err.find(report + ": error: ") != std::string::npos, result.err);
    CHECK(std::ranges::count(result.err, '\n') == 1);
  }
  CHECK_FALSE(fs::exists(project.folder / "again"));
}

TEST_CASE("an input that a report names is a regular file") {
  const Project project;
  REQUIRE(project.run("scene.xml --quiet").exit_code == 0);
  for (const char* input : {"/dev/zero", "fifo"}) {
    CAPTURE(input);
    if (std::string_view(input) == "fifo") REQUIRE(::mkfifo((project.folder / "fifo").c_str(), 0600) == 0);
    edit_report(project, [&](auto& json) { json["inputs"] = {{input, std::string(64, '0')}}; });
    const ProcessResult result = project.run("--again out/run.json --out again");
    CHECK(result.exit_code == 2);
    CHECK(result.err.find(std::string(input) + ": error: is not a regular file") != std::string::npos);
  }
}

TEST_CASE("scenes whose names are no UTF-8 are made again and gone on with") {
  const Project project;
  // An 0xe9 of Latin-1, and U+FFFD itself, which stands in a report for other bytes.
  const std::string name = "sc\xe9ne \xef\xbf\xbd.xml", quoted = "'" + name + "'";
  fs::rename(project.folder / "scene.xml", project.folder / name);
  REQUIRE(project.run(quoted + " --frames 2 --quiet").exit_code == 0);
  const auto json = nlohmann::json::parse(read_text(project.folder / "out/run.json"));
  CHECK(json["scene"] ==
        "sc\xef\xbf\xbd"
        "E9ne \xef\xbf\xbd"
        "EF\xef\xbf\xbd"
        "BF\xef\xbf\xbd"
        "BD.xml");
  const ProcessResult again = project.run("--again out/run.json --out again --quiet");
  INFO(again.err);
  CHECK(again.exit_code == 0);
  CHECK(again.err == "");
  CHECK(read_text(project.folder / "again/SCAN.csv") == read_text(project.folder / "out/SCAN.csv"));
  for (const std::string& options :
       {std::string("--resume --frames 3 --quiet"), quoted + " --resume --frames 4 --quiet"}) {
    const ProcessResult resumed = project.run(options);
    INFO(resumed.err);
    CHECK(resumed.exit_code == 0);
  }
  CHECK(nlohmann::json::parse(read_text(project.folder / "out/run.json"))["frames"] == 4);
}

TEST_CASE("a run whose folder has links to elsewhere removes and continues nothing there") {
  const Project project;
  REQUIRE(project.run("scene.xml --quiet --frames 2").exit_code == 0);
  const fs::path elsewhere = project.folder / "elsewhere";
  fs::rename(project.folder / "out/CAM", elsewhere);
  fs::create_directory_symlink(elsewhere, project.folder / "out/CAM");
  const Strings before = files_below(elsewhere);
  REQUIRE_FALSE(before.empty());
  for (const std::string options :
       {"scene.xml --quiet", "--resume --frames 3 --quiet", "scene.xml --resume --frames 3"}) {
    CAPTURE(options);
    const ProcessResult result = project.run(options);
    CHECK(result.exit_code == 2);
    CHECK_MESSAGE(result.err.find("out/CAM: error: is a link that leads out of out") != std::string::npos, result.err);
    CHECK(files_below(elsewhere) == before);
  }
  fs::remove(project.folder / "out/CAM");
  fs::rename(elsewhere, project.folder / "out/CAM");
  const std::string table = read_text(project.folder / "out/SCAN.csv");
  fs::rename(project.folder / "out/SCAN.csv", elsewhere);
  fs::create_symlink(elsewhere, project.folder / "out/SCAN.csv");
  CHECK(project.run("--resume --frames 3 --quiet").exit_code == 2);
  CHECK(read_text(elsewhere) == table);
}

TEST_CASE("SHA-256 as FIPS 180-4 has it for \"abc\"") {
  const TemporaryFolder folder;
  write_text(folder / "abc", "abc");
  CHECK(sha256_of(folder / "abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
