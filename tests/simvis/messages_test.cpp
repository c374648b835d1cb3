// What simvis-run says of warnings and of mistakes on its command line.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "tests/support/error_of.h"
#include "tests/support/run_process.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kStage = R"(
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="3" min_angle="-5" max_angle="5"/>)";

/// simvis-run on a scene with the wall and `commands`, in a folder of its own.
class ToldRun {
 public:
  explicit ToldRun(std::vector<std::string> options, std::string_view commands = kStage,
                   const std::string& trajectory = "") {
    const fs::path scene = write_wall_scene(folder_.path(), commands);
    if (!trajectory.empty()) {
      write_text(folder_ / "drive.csv", trajectory);
      options.insert(options.end(), {"--trajectory", (folder_ / "drive.csv").string()});
    }
    options.insert(options.begin(), tested_build() + "/bin/simvis-run");
    options.insert(options.end(), {"-o", (folder_ / "out").string(), scene.string()});
    result = Process(options).wait();
  }
  nlohmann::json json() const { return nlohmann::json::parse(read_text(folder_ / "out/run.json")); }
  std::string scan() const { return read_text(folder_ / "out/SCAN.csv"); }
  ProcessResult result;

 private:
  TemporaryFolder folder_;
};

constexpr std::string_view kBeats =
    R"(<sensor type="camera" name="C" insert_at="ROOT" width="4" height="4" rate="10"/>)";

TEST_CASE("warnings are printed, counted and kept, with --quiet too") {
  for (const bool quiet : {false, true}) {
    const ToldRun run(quiet ? std::vector<std::string>{"--quiet"} : std::vector<std::string>{}, kBeats);
    CHECK(run.result.exit_code == 0);
    CHECK(run.result.err.starts_with("warning: "));
    CHECK(contains(run.result.err, "scene.xml:3:70: sensor \"C\" is due 10 times a second"));
    CHECK(std::ranges::count(run.result.err, '\n') == 1);
    REQUIRE(run.json()["warnings"].size() == 1);
    CHECK("warning: " + run.json()["warnings"][0].get<std::string>() + "\n" == run.result.err);
    CHECK(run.result.out.empty() == quiet);
    if (!quiet) CHECK(contains(run.result.out, "; 1 warning\n"));
  }
  const ToldRun none({});
  CHECK(none.result.err.empty());
  CHECK(none.json()["warnings"].empty());
  CHECK(contains(none.result.out, " s with loading and files: "));
  CHECK(contains(none.result.out, "; 0 warnings\n"));
}

TEST_CASE("--strict makes warnings errors") {
  const ToldRun strict({"--strict"}, kBeats);
  CHECK(strict.result.exit_code == 2);
  CHECK(contains(strict.result.err, "scene.xml:3:70: error: sensor \"C\" is due 10 times a second"));
  CHECK(ToldRun({"--strict"}).result.exit_code == 0);
}

TEST_CASE("--rate auto") {
  const ToldRun run({"--rate", "auto", "--frames", "3"}, kBeats);
  CHECK(run.result.err.empty());
  CHECK(run.json()["rate_hz"] == "auto");
  CHECK(run.json()["sensors"]["C"]["frames"] == 3);
  CHECK(contains(run.result.out, "x real time at 10 Hz; "));
  CHECK(contains(ToldRun({"--rate", "fast"}).result.err, "expected a number (Hz) or auto"));
  CHECK(ToldRun({"--rate", "auto", "--price"}).result.exit_code == 2);
}

TEST_CASE("a trajectory without --frames runs to its end") {
  const std::string drive = "time_s,MOVE.x\n0,0\n2,1\n";
  CHECK(ToldRun({"--rate", "5"}, kStage, drive).json()["frames"] == 11);
  CHECK(ToldRun({"--rate", "5", "--frames", "2"}, kStage, drive).json()["frames"] == 2);
  CHECK(ToldRun({}, kStage, "time_s,MOVE.x\n-1,0\n").json()["frames"] == 1);
  const ToldRun due({"--rate", "auto"}, std::string(kStage) + std::string(kBeats), drive);
  CHECK(due.json()["frames"] == 21);
}

TEST_CASE("a parameter that is set twice") {
  const ToldRun twice({"--set", "MOVE.x=1", "--set", "MOVE.y=1", "--set", "MOVE.x=2"});
  CHECK(twice.result.exit_code == 0);
  CHECK(twice.result.err ==
        "warning: --set MOVE.x: is given more than once, and the last value applies; expected once\n");
  CHECK(ToldRun({"--set", "MOVE.x=1", "--set", "MOVE.y=1"}).result.err.empty());
  const std::string drive = "time_s,MOVE.x\n0,0\n0.05,1\n";
  CHECK(contains(ToldRun({"--set", "MOVE.x=1"}, kStage, drive).result.err,
                 "warning: --set MOVE.x: the trajectory sets it too"));
  CHECK(ToldRun({"--set", "MOVE.y=1"}, kStage, drive).result.err.empty());
}

TEST_CASE("an assignment in two arguments is named, not the scene behind it") {
  const ToldRun split({"--set", "MOVE.yaw", "3"});
  CHECK(split.result.exit_code == 2);
  CHECK(contains(split.result.err, "--set MOVE.yaw: expected ELEMENT.PARAM=VALUE in one argument; see --help"));
}

TEST_CASE("a name that hides the format of a result is a warning") {
  const TemporaryFolder folder;
  const auto err = [&](const std::string& option, const std::string& name) {
    return ToldRun({option, name.starts_with("/dev/") ? name : (folder / name).string()}).result.err;
  };
  for (const auto& [option, ending] : {std::pair{"--record", ".mcap"}, {"--page", ".html"}, {"--export", ".glb"}}) {
    CHECK(contains(err(option, "a.bag"), "a.bag: expected a name that ends with " + std::string(ending)));
    CHECK(contains(err(option, "a"), "expected a name that ends with " + std::string(ending)));
    CHECK(err(option, "a" + std::string(ending)).empty());
  }
  CHECK(err("--record", "bag/").empty());
  CHECK(err("--page", "/dev/null").empty());
}

TEST_CASE("options that do not exist are named, not the arguments behind them") {
  const ToldRun frame({"--frame", "3"});
  CHECK(frame.result.exit_code == 2);
  CHECK(contains(frame.result.err, "there is no option --frame, did you mean \"--frames\"?; see --help"));
  CHECK_FALSE(frame.result.err.find("scene.xml") != std::string::npos);
  CHECK(contains(ToldRun({"--otu=x"}).result.err, "there is no option --otu, did you mean \"--out\"?"));
  CHECK(contains(ToldRun({"-x"}).result.err, "there is no option -x"));
}

TEST_CASE("mistakes that have a hint of their own") {
  CHECK(contains(ToldRun({"--set", "SCAN.samples=5"}).result.err,
                 "--set SCAN.samples=5: there is no element \"SCAN\": it is a sensor"));
  CHECK(contains(ToldRun({"--set", "WALL.x=5"}).result.err, "there is no element \"WALL\": it is a part"));
  CHECK(contains(ToldRun({"--device", "nvidia geforce"}).result.err,
                 "no Vulkan device matches \"nvidia geforce\", expected an index or a part of a name: 0 ("));
  CHECK(
      contains(ToldRun({}, R"(<element type="pose" name="P" insert_at="ROOT" pose_offset="0 0 0 0 0 0"/>)").result.err,
               "scene.xml:3:48: error: attribute \"pose_offset\" is not allowed on an element, expected it on a part"));
  const ProcessResult help = Process({tested_build() + "/bin/simvis-run", "-h"}).wait();
  CHECK(help.exit_code == 0);
  CHECK(contains(help.out, "-o,--out"));
}

TEST_CASE("a part's file given as the scene") {
  const TemporaryFolder folder;
  const std::string urdf = R"(<robot name="r"><link name="base"/></robot>)";
  write_text(folder / "r.urdf", urdf);
  write_text(folder / "r.xml", urdf);
  for (const char* name : {"r.urdf", "r.xml"}) {
    const ProcessResult result =
        Process({tested_build() + "/bin/simvis-run", (folder / name).string(), "-o", (folder / "out").string()}).wait();
    CHECK(result.exit_code == 2);
    CHECK(contains(result.err, "put it into one: <part file=\"r.urdf\" name="));
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
