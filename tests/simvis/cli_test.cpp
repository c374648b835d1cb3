// simvis-run as its users see it: files, text and exit codes, for good input and bad.
#include <doctest/doctest.h>
#include <sys/mount.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include <simvis/ray_caster.h>
#include "tests/support/picture_files.h"
#include "tests/support/run_process.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;
using Strings = std::vector<std::string>;

const std::string kProgram = tested_build() + "/bin/simvis-run";

// The wall stands square to the camera and the scanner, 4 m and 3 m away.
constexpr std::string_view kSensors = R"(
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="64" height="48" hfov="60" outputs="color depth"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5" min_angle="-60" max_angle="60" range_max="7"
        pose_offset="1 0 0 0 0 0"/>
<sensor type="camera" name="SLOW" insert_at="ROOT" width="8" height="8" rate="1"/>)";

ProcessResult run(Strings arguments, const Strings& environment = {}) {
  arguments.insert(arguments.begin(), kProgram);
  return Process(arguments, environment).wait();
}

/// Runs simvis-run on a scene that it must refuse before anything is rendered: nothing is written.
void check_refused(const Strings& options, const std::string& commands, const Strings& expected) {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), commands);
  Strings arguments = {scene.string(), "--out", (folder / "out").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const ProcessResult result = run(arguments);
  INFO(commands, " ", result.err);
  CHECK(result.exit_code == 2);
  CHECK(result.out == "");
  for (const std::string& text : expected) {
    CHECK_MESSAGE(result.err.find(text) != std::string::npos, "\"", text, "\" is missing");
  }
  CHECK(files_below(folder.path()) == Strings{"scene.xml", "wall.gltf"});
  CHECK_FALSE(fs::exists(folder / "out"));
}

struct Table {
  Strings columns;
  std::vector<Strings> rows;
};

Strings cells(const std::string& line) {
  Strings result{""};
  for (const char c : line) {
    if (c == ',') {
      result.emplace_back();
    } else {
      result.back() += c;
    }
  }
  return result;
}

Table read_csv(const fs::path& file) {
  std::istringstream in(read_text(file));
  Table table;
  std::string line;
  std::getline(in, line);
  table.columns = cells(line);
  while (std::getline(in, line)) table.rows.push_back(cells(line));
  return table;
}

TEST_CASE("a run writes pictures, scans and run.json, and says where") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  const std::string out = (folder / "out").string();
  const ProcessResult result = run({scene.string(), "--out", out, "--frames", "3", "--seed", "7"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.err == "");
  CHECK(files_below(out) == Strings{"CAM.yaml", "CAM/000000.exr", "CAM/000000.png", "CAM/000001.exr", "CAM/000001.png",
                                    "CAM/000002.exr", "CAM/000002.png", "CAM_poses.csv", "CAM_poses.tum", "SCAN.csv",
                                    "SCAN_poses.csv", "SCAN_poses.tum", "SLOW.yaml", "SLOW/000000.png",
                                    "SLOW_poses.csv", "SLOW_poses.tum", "run.json"});
  CHECK(result.out.find(out + "/CAM/*.png") != std::string::npos);
  CHECK(result.out.find(out + "/SCAN.csv") != std::string::npos);
  CHECK(result.out.find("x real time at 15 Hz") != std::string::npos);

  const auto json = nlohmann::json::parse(read_text(folder / "out/run.json"));
  CHECK(json["scene"] == scene.string());
  CHECK(json["seed"] == 7);
  CHECK(json["frames"] == 3);
  CHECK(json["device"].get<std::string>() != "");
  CHECK(json["driver"].get<std::string>() != "");
  CHECK(json["wall_s"].get<double>() > 0);
  CHECK(json["frame_ms"]["median"].get<double>() > 0);
  CHECK(json["frame_ms"]["p99"].get<double>() >= json["frame_ms"]["median"].get<double>());
  CHECK(json["sensors"]["CAM"]["type"] == "camera");
  CHECK(json["sensors"]["CAM"]["frames"] == 3);
  CHECK(json["sensors"]["SLOW"]["frames"] == 1);
  CHECK(json["sensors"]["SCAN"]["method"] == "raycast");
  CHECK(json["sensors"]["SCAN"]["effects"].empty());
}

TEST_CASE("pictures and ranges of a wall are where geometry puts them") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  REQUIRE(run({scene.string(), "--out", (folder / "out").string(), "--frames", "2", "--quiet"}).exit_code == 0);

  const PngPicture png = read_png(folder / "out/CAM/000000.png");
  REQUIRE(png.channels == 3);
  REQUIRE(png.width == 64);
  REQUIRE(png.height == 48);
  // Unlit linear 1, 0.5, 0.25: sRGB 255, 187.5, 136.96; one code for the rounding of the colour target.
  const std::uint8_t* const middle = &png.pixels[3 * (24 * 64 + 32)];
  CHECK(middle[0] == 255);
  CHECK(std::abs(middle[1] - 187.5) <= 1);
  CHECK(std::abs(middle[2] - 137) <= 1);

  const ExrPicture exr = read_exr(folder / "out/CAM/000000.exr");
  REQUIRE(exr.channels.size() == 4);
  // Depth along the axis is 4 m everywhere. d = near / z and z = near / d each round once, and so do the vertices and
  // the interpolation: a handful of 2^-24 relative.
  constexpr float kDepthRounding = 4 * 8 * 0x1p-24f;
  const auto [low, high] = std::minmax_element(exr.channels.at("Z").begin(), exr.channels.at("Z").end());
  CHECK(*low >= 4 - kDepthRounding);
  CHECK(*high <= 4 + kDepthRounding);

  const Table scan = read_csv(folder / "out/SCAN.csv");
  CHECK(scan.columns == Strings{"frame", "time_s", "ring", "beam", "azimuth_deg", "elevation_deg", "range_m",
                                "error_bound_m", "x_m", "y_m", "z_m"});
  REQUIRE(scan.rows.size() == 10);
  for (std::size_t row = 0; row < 10; ++row) {
    const Strings& cell = scan.rows[row];
    const std::size_t beam = row % 5;
    const double azimuth_deg = -60 + 30.0 * static_cast<double>(beam);
    CHECK(cell[0] == (row < 5 ? "0" : "1"));
    CHECK(cell[1] == (row < 5 ? "0.000000000" : "0.066666667"));
    CHECK(cell[2] == "0");
    CHECK(cell[3] == std::to_string(beam));
    CHECK(std::stod(cell[4]) == doctest::Approx(azimuth_deg));
    CHECK(std::stod(cell[5]) == 0);
    const double range_m = std::stod(cell[6]), bound_m = std::stod(cell[7]);
    CHECK(std::abs(range_m - 3 / std::cos(azimuth_deg * M_PI / 180)) <= bound_m);
    CHECK(bound_m < 1e-3);
    // The point follows from the range, both printed with nine digits.
    CHECK(std::abs(std::stod(cell[8]) - range_m * std::cos(azimuth_deg * M_PI / 180)) < 1e-7);
    CHECK(std::abs(std::stod(cell[9]) - range_m * std::sin(azimuth_deg * M_PI / 180)) < 1e-7);
    CHECK(std::stod(cell[10]) == 0);
  }
}

TEST_CASE("a beam that hits nothing has no point") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(
      folder.path(),
      R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="2" min_angle="0" max_angle="180"/>)");
  REQUIRE(run({scene.string(), "--out", (folder / "out").string(), "--quiet"}).exit_code == 0);
  const Table scan = read_csv(folder / "out/SCAN.csv");
  REQUIRE(scan.rows.size() == 2);
  CHECK(scan.rows[1][6] == "inf");
  CHECK(scan.rows[1][8] == "");
  CHECK(scan.rows[1][9] == "");
  CHECK(scan.rows[1][10] == "");
}

TEST_CASE("--set, --trajectory and --rate move what stands behind an element") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  const std::string out = (folder / "out").string();
  write_text(folder / "drive.csv", "time_s,MOVE.x\n0,0\n1,2\n");
  REQUIRE(run({scene.string(), "--out", out, "--frames", "3", "--rate", "2", "--trajectory",
               (folder / "drive.csv").string(), "--set", "MOVE.y=-1", "--set", "MOVE.z=0.5", "--sensor", "SCAN"})
              .exit_code == 0);
  // Only the scanner was on.
  CHECK(files_below(out) == Strings{"SCAN.csv", "SCAN_poses.csv", "SCAN_poses.tum", "run.json"});
  const Table scan = read_csv(folder / "out/SCAN.csv");
  REQUIRE(scan.rows.size() == 15);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    const Strings& middle = scan.rows[5 * frame + 2];
    CHECK(std::stod(middle[1]) == 0.5 * static_cast<double>(frame));
    CHECK(std::abs(std::stod(middle[6]) - (3 - static_cast<double>(frame))) <= std::stod(middle[7]));
  }
}

TEST_CASE("--method is put over the scene's own and reported") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  REQUIRE(run({scene.string(), "--out", (folder / "out").string(), "--method", "nearest"}).exit_code == 0);
  const auto json = nlohmann::json::parse(read_text(folder / "out/run.json"));
  CHECK(json["sensors"]["SCAN"]["method"] == "nearest");
  check_refused({"--method", "sonar"}, std::string(kSensors), {"--method", "sonar", "nearest", "planar"});
  check_refused({"--method", "sonar"}, "", {"--method", "sonar"});  // also where there is no scanner
}

TEST_CASE("--method drops a scene's tolerance that it does not look at") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(
      folder.path(), R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" max_error_m="0.01"/>)");
  for (const std::string method : {"nearest", "planar", "hybrid", "raycast"}) {
    const ProcessResult result = run({scene.string(), "--out", (folder / "out").string(), "--method", method});
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    CHECK(nlohmann::json::parse(read_text(folder / "out/run.json"))["sensors"]["SCAN"]["method"] == method);
  }
}

TEST_CASE("--max-error: hybrid over the scene's own method; the price list of auto, and what run.json says") {
  const TemporaryFolder folder;
  const Strings cache{"XDG_CACHE_HOME=" + (folder / "cache").string()};
  const fs::path scene = write_wall_scene(
      folder.path(), std::string(kSensors) + R"(<sensor type="laser_scanner" name="NEAREST" insert_at="ROOT"
                         method="nearest"/>)");
  const std::string out = (folder / "out").string();
  REQUIRE(run({scene.string(), "--out", out, "--max-error", "0.001"}, cache).exit_code == 0);
  for (const char* name : {"SCAN", "NEAREST"}) {
    CHECK(nlohmann::json::parse(read_text(folder / "out/run.json"))["sensors"][name]["method"] == "hybrid");
  }
  for (const Strings& row : read_csv(folder / "out/SCAN.csv").rows) CHECK(std::stod(row[7]) <= 0.001);

  const ProcessResult result =
      run({scene.string(), "--out", out, "--max-error", "0.001", "--method", "auto", "--explain"}, cache);
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const auto json = nlohmann::json::parse(read_text(folder / "out/run.json"));
  for (const char* name : {"SCAN", "NEAREST"}) {
    const auto& sensor = json["sensors"][name];
    CHECK(sensor["method"] == "auto");
    const std::string chosen = sensor["chosen"];
    CHECK((chosen == "raycast" || chosen.starts_with("hybrid ")));
    CHECK(sensor["chosen_because"].get<std::string>().find("no bound above 0.001 m") != std::string::npos);
    CHECK(sensor["predicted_ms"].get<double>() > 0);
    CHECK(sensor["surveys"] == 1);
    CHECK(sensor["cast_share"] == 1);  // a survey casts every beam
    CHECK(result.out.find(std::string("price list of ") + name) != std::string::npos);
    CHECK(result.out.find("  * " + chosen + ": ") != std::string::npos);
  }
  for (const Strings& row : read_csv(folder / "out/SCAN.csv").rows) CHECK(std::stod(row[7]) <= 0.001);

  for (const char* method : {"auto", "hybrid"}) {
    REQUIRE(
        run({scene.string(), "--out", out, "--max-error", "1e-5", "--method", method, "--quiet"}, cache).exit_code ==
        0);
    CHECK(nlohmann::json::parse(read_text(folder / "out/run.json"))["sensors"]["SCAN"]["method"] == method);
    for (const Strings& row : read_csv(folder / "out/SCAN.csv").rows) CHECK(std::stod(row[7]) <= 1e-5);
  }

  const std::string commands(kSensors);
  for (const char* method : {"nearest", "planar", "raycast"}) {
    check_refused({"--max-error", "0.001", "--method", method}, commands,
                  {"simvis-run: --max-error: ", method, "does not look at it"});
  }
  for (const char* wrong : {"0", "-1", "nan", "inf", "much", ""}) {
    check_refused({"--max-error", wrong}, commands, {"--max-error"});
  }
  check_refused({"--max-error", "0"}, "", {"--max-error", "0 is not allowed, expected a number greater than 0 (m)"});

  const ProcessResult unreachable =
      run({scene.string(), "--out", (folder / "none").string(), "--max-error", "1e-9"}, cache);
  CHECK(unreachable.exit_code == 2);
  CHECK(unreachable.err.find("simvis-run: --max-error: error: attribute \"max_error_m\": 1e-09 is met by no method "
                             "for sensor \"SCAN\"") != std::string::npos);
  CHECK(files_below(folder / "none").empty());
}

TEST_CASE("--summary adds lines at the end and changes no result") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  const std::string out = (folder / "out").string();
  const ProcessResult plain = run({scene.string(), "--out", (folder / "plain").string()});
  const ProcessResult result = run({scene.string(), "--out", out, "--summary"});
  INFO(result.err);
  REQUIRE(plain.exit_code == 0);
  REQUIRE(result.exit_code == 0);
  for (const char* text : {"scanners: 1 with 5 beams", "cameras: ", "what accuracy costs SCAN", "\n  nearest ",
                           "\n  planar ", "\n  hybrid ", "\n  raycast "}) {
    CHECK_MESSAGE(result.out.find(text) != std::string::npos, text);
  }
  CHECK(result.out.ends_with("/SCAN.csv, " + out + "/run.json\n"));
  CHECK(plain.out.find("open first") == std::string::npos);
  CHECK(files_below(out) == files_below(folder / "plain"));
  CHECK(read_text(folder / "out/SCAN.csv") == read_text(folder / "plain/SCAN.csv"));
  for (const char* other : {"--quiet", "--price"}) {
    check_refused({"--summary", other}, std::string(kSensors), {"--summary", other});
  }
}

TEST_CASE("--explain, --profile, --quiet, --describe, --list-devices, --version, --help") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  const std::string out = (folder / "out").string();
  const ProcessResult explained = run({scene.string(), "--out", out, "--explain", "--quiet", "--frames", "2",
                                       "--profile", (folder / "p.json").string()});
  CHECK(explained.exit_code == 0);
  CHECK(explained.out.find("CAM") != std::string::npos);
  CHECK(explained.out.find("SCAN") != std::string::npos);
  CHECK(explained.out.find(" draws, ") != std::string::npos);
  CHECK(explained.out.find("wrote") == std::string::npos);
  Strings stages;
  const auto profile = nlohmann::json::parse(read_text(folder / "p.json"));
  for (const auto& event : profile["traceEvents"]) {
    if (event.value("cat", "") == "stage") stages.push_back(event["name"]);
  }
  CHECK(stages == Strings{"elements", "flatten", "plan", "render", "collect", "write", "elements", "flatten", "plan",
                          "render", "collect", "write"});

  const ProcessResult quiet = run({scene.string(), "--out", out, "--quiet"});
  CHECK(quiet.exit_code == 0);
  CHECK(quiet.out == "");
  CHECK(quiet.err == "");

  const ProcessResult described = run({"--describe", "camera"});
  CHECK(described.exit_code == 0);
  for (const char* name : {"width", "height", "hfov", "near", "outputs", "rate"}) {
    CHECK(described.out.find(name) != std::string::npos);
  }
  const ProcessResult effect = run({"--describe", "beam_divergence"});
  CHECK(effect.exit_code == 0);
  for (const char* part : {"divergence_samples", "called for by", "shown in: ranges", "laser_scanner"}) {
    CHECK(effect.out.find(part) != std::string::npos);
  }
  const ProcessResult unknown = run({"--describe", "camra"});
  CHECK(unknown.exit_code == 2);
  CHECK(unknown.err.find("did you mean \"camera\"?") != std::string::npos);

  const ProcessResult devices = run({"--list-devices"});
  CHECK(devices.exit_code == 0);
  CHECK(devices.out.starts_with("0: "));
  CHECK(devices.out.find("usable") != std::string::npos);

  CHECK(run({"--version"}).out.starts_with("simvis-run 0."));
  const ProcessResult help = run({"--help"});
  CHECK(help.exit_code == 0);
  for (const char* option : {"--out", "--frames", "--rate", "--set", "--trajectory", "--sensor", "--method",
                             "--max-error", "--seed", "--device", "--list-devices", "--explain", "--profile", "--quiet",
                             "--summary", "--describe", "--plugin", "--version", "--help"}) {
    CHECK_MESSAGE(help.out.find(option) != std::string::npos, option);
  }
}

TEST_CASE("a wrong command line") {
  const std::string scene(kSensors);
  check_refused({"--frames", "0"}, scene, {"simvis-run: --frames: ", "1 or more"});
  check_refused({"--frames", "-3"}, scene, {"simvis-run: ", "--frames"});
  check_refused({"--frames", "1.5"}, scene, {"--frames"});
  for (const char* rate : {"0", "-1", "nan", "inf", "1e-300"})
    check_refused({"--rate", rate}, scene, {"simvis-run: --rate: "});
  check_refused({"--rate", "fast"}, scene, {"--rate"});
  check_refused({"--seed", "x"}, scene, {"--seed"});
  check_refused({"--seed", "18446744073709551616"}, scene, {"--seed"});
  check_refused({"--sensor", "CAN"}, scene, {"--sensor", "CAN", "did you mean \"CAM\"?"});
  check_refused({"--set", "MOVE.yaw"}, scene, {"--set MOVE.yaw", "expected ELEMENT.PARAM=VALUE"});
  check_refused({"--set", "MOVE=1"}, scene, {"expected ELEMENT.PARAM=VALUE"});
  check_refused({"--set", "MOVE.yaw=nan"}, scene, {"\"nan\"", "finite"});
  check_refused({"--set", "MOVE.yaw=1 2"}, scene, {"\"1 2\""});
  check_refused({"--set", "MOVE.yow=1"}, scene, {"yow", "did you mean \"yaw\"?"});
  check_refused({"--set", "MOV.yaw=1"}, scene, {"MOV", "did you mean \"MOVE\"?"});
  check_refused({"--trajectory", "/nonexistent.csv"}, scene, {"/nonexistent.csv"});
  check_refused({"--plugin", "/nonexistent.so"}, scene, {"/nonexistent.so: error: ", "cannot open shared object file"});
  check_refused({"--device", "no such device"}, scene, {"no such device"});
  check_refused({"--colour"}, scene, {"--colour", "--help"});
  check_refused({"second.xml"}, scene, {"second.xml"});

  const ProcessResult nothing = run({});
  CHECK(nothing.exit_code == 2);
  CHECK(nothing.err.find("SCENE.xml is missing") != std::string::npos);
}

TEST_CASE("a wrong scene") {
  const std::string camera = R"(<sensor type="camera" name="C" insert_at="ROOT" )";
  // The commands begin on line 3.
  check_refused({}, "<part file=", {"scene.xml:", ": error: "});
  check_refused({}, R"(<prt file="wall.gltf" name="W" insert_at="ROOT"/>)", {"scene.xml:3:2: error: ", "part"});
  check_refused({}, R"(<sensor type="camra" name="C" insert_at="ROOT"/>)", {"scene.xml:3:", "camra", "\"camera\"?"});
  check_refused({}, R"(<element type="poes" name="P" insert_at="ROOT"/>)", {"scene.xml:3:", "poes", "\"pose\"?"});
  check_refused({}, camera + R"(widht="5"/>)", {"scene.xml:3:49: error: ", "widht", "\"width\"?"});
  check_refused({}, R"(<sensor type="camera" name="C" insert_at="WAL"/>)", {"scene.xml:3:", "WAL", "\"WALL\"?"});
  check_refused({}, camera + "/>\n" + camera + "/>", {"scene.xml:4:", "\"C\""});
  check_refused({}, camera + R"(near="nan"/>)", {"scene.xml:3:", "near", "nan"});
  check_refused({}, camera + R"(pose_offset="0 0 0 0 inf 0"/>)", {"scene.xml:3:", "pose_offset"});
  check_refused({}, camera + R"(width="0"/>)", {"scene.xml:3:", "width", "0"});
  check_refused({}, camera + R"(height="-1"/>)", {"scene.xml:3:", "height"});
  check_refused({}, camera + R"(hfov="0"/>)", {"scene.xml:3:", "hfov"});
  check_refused({}, camera + R"(hfov="360"/>)", {"scene.xml:3:", "hfov"});
  check_refused({}, R"(<part file="gone.glb" name="G" insert_at="ROOT"/>)", {"gone.glb"});
  check_refused({}, R"(<sensor type="camera" name="a/b" insert_at="ROOT"/>)", {"a/b"});
}

TEST_CASE("a scene or part that cannot be read") {
  const TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  const ProcessResult missing = run({(folder / "missing.xml").string(), "--out", out});
  CHECK(missing.exit_code == 2);
  CHECK(missing.err.starts_with((folder / "missing.xml").string()));
  const ProcessResult is_folder = run({folder.path().string(), "--out", out});
  CHECK(is_folder.exit_code == 2);

  // A GLB whose header promises more than there is.
  write_text(folder / "cut.glb", std::string("glTF\x02\0\0\0\xff\0\0\0\x20\0\0\0JSON{\"asset\"", 28));
  write_text(folder / "cut.xml", R"(<part file="cut.glb" name="P" insert_at="ROOT"/>)");
  const ProcessResult cut = run({(folder / "cut.xml").string(), "--out", out});
  CHECK(cut.exit_code == 2);
  CHECK(cut.err.find("cut.glb") != std::string::npos);
  CHECK(cut.err.find("error: ") != std::string::npos);
  CHECK(files_below(folder.path()) == Strings{"cut.glb", "cut.xml"});
}

TEST_CASE("no Vulkan driver") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  const Strings none = {"VK_DRIVER_FILES=/nonexistent.json", "VK_ICD_FILENAMES=/nonexistent.json",
                        "VK_ADD_DRIVER_FILES="};
  const ProcessResult result = run({scene.string(), "--out", (folder / "out").string()}, none);
  CHECK(result.exit_code == 1);
  CHECK(result.err.starts_with("simvis-run: error: "));
  CHECK(result.err.find("Vulkan") != std::string::npos);
  CHECK_FALSE(fs::exists(folder / "out"));
  CHECK(run({"--list-devices"}, none).exit_code == 1);
}

TEST_CASE("an output folder that cannot be written") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  // Permissions do not bind root, so: a path below a file, and a file system that takes no files.
  for (const std::string& out :
       {scene.string(), scene.string() + "/out", std::string("/proc"), std::string("/proc/out")}) {
    const ProcessResult result = run({scene.string(), "--out", out});
    INFO(result.err);
    CHECK(result.exit_code == 1);
    CHECK(result.err.starts_with(out));
    CHECK(result.err.find(": error: ") != std::string::npos);
  }
  const ProcessResult profile =
      run({scene.string(), "--out", (folder / "out").string(), "--profile", scene.string() + "/p.json"});
  CHECK(profile.exit_code == 1);
  CHECK(profile.err.starts_with(scene.string() + "/p.json: error: "));
  CHECK(files_below(folder.path()) == Strings{"scene.xml", "wall.gltf"});
}

/// Every file is whole: pictures can be read, tables end with a line's end, nothing temporary is left.
void check_all_whole(const fs::path& folder, const std::string& status) {
  for (const std::string& name : files_below(folder)) {
    INFO(name);
    CHECK_FALSE(name.ends_with(".tmp"));
    if (name.ends_with(".csv")) CHECK(read_text(folder / name).ends_with('\n'));
    if (name == "run.json") CHECK(nlohmann::json::parse(read_text(folder / name))["status"] == status);
    if (name.ends_with(".png")) CHECK(read_png(folder / name).width > 0);
    if (name.ends_with(".exr")) CHECK(read_exr(folder / name).width > 0);
  }
}

/// A file system of 256 KiB, as long as it lives.
class SmallDisk {
 public:
  explicit SmallDisk(const fs::path& folder)
      : folder_(folder), mounted_(::mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=256k") == 0) {}
  ~SmallDisk() {
    if (mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  explicit operator bool() const { return mounted_; }

 private:
  fs::path folder_;
  bool mounted_;
};

TEST_CASE("a disk that runs full") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  const fs::path disk = folder / "disk";
  fs::create_directory(disk);
  const SmallDisk mounted(disk);
  if (!mounted) {
    MESSAGE("not tested with a full file system: mounting a small tmpfs is not permitted here");
    return;
  }
  const ProcessResult result = run({scene.string(), "--out", (disk / "out").string(), "--frames", "100000"});
  CHECK(result.exit_code == 1);
  CHECK(result.err.starts_with(disk.string()));
  CHECK(result.err.find("No space left on device") != std::string::npos);
  CHECK_FALSE(files_below(disk).empty());
  check_all_whole(disk / "out", "running");  // there is no room to say more
}

TEST_CASE("a limit on the size of files") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  // One block of 512 bytes: the first picture does not fit.
  const ProcessResult result = Process({"/bin/sh", "-c", "ulimit -f 1; exec \"$@\"", "sh", kProgram, scene.string(),
                                        "--out", (folder / "out").string()})
                                   .wait();
  CHECK(result.exit_code == 1);
  CHECK(result.err.find("File too large") != std::string::npos);
  check_all_whole(folder / "out", "running");
}

TEST_CASE("standard output that cannot be written") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kSensors);
  const ProcessResult result = Process({"/bin/sh", "-c", "exec \"$@\" > /dev/full", "sh", kProgram, scene.string(),
                                        "--out", (folder / "out").string()})
                                   .wait();
  CHECK(result.exit_code == 1);
  CHECK(result.err.find("standard output") != std::string::npos);
}

TEST_CASE("a signal ends the run and leaves nothing half-written") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    const fs::path scene = write_wall_scene(folder.path(), kSensors);
    Process process({kProgram, scene.string(), "--out", (folder / "out").string(), "--frames", "100000000"});
    for (int i = 0; i < 60'000 && !fs::exists(folder / "out/CAM/000002.png"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    process.send(signal);
    const ProcessResult result = process.wait();
    INFO(result.err);
    CHECK(result.exit_code == 130);
    CHECK(result.err.find("signal") != std::string::npos);
    CHECK(fs::exists(folder / "out/CAM/000002.png"));
    check_all_whole(folder / "out", "stopped");
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
