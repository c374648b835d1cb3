// simvis-run --threads: the files have the same bytes for every number of threads.
#include <doctest/doctest.h>

#include <filesystem>
#include <iterator>
#include <map>
#include <string>

#include <simvis/simulation.h>
#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr std::string_view kThreadedSensors = R"(
  <sensor type="laser_scanner" name="SCANNER" insert_at="ROOT" method="raycast" samples="4096" range_noise="0.01"/>
  <sensor type="camera" name="CAMERA" insert_at="ROOT" width="160" height="120" outputs="color depth"/>
)";

/// All but run.json, which has times in it.
std::map<std::string, std::string> files_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const std::string& file : files_below(folder)) {
    if (file != "run.json") files[file] = read_text(folder / file);
  }
  return files;
}

std::ptrdiff_t threads_of_process() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {});
}

}  // namespace

TEST_CASE("the files of a run do not depend on --threads") {
  const TemporaryFolder folder;
  const std::string scene = write_wall_scene(folder.path(), kThreadedSensors).string();
  std::map<std::string, std::string> expected;
  for (const std::string threads : {"1", "2", "3", "8", "0"}) {
    CAPTURE(threads);
    const std::filesystem::path out = folder / ("out" + threads);
    const ProcessResult run =
        Process({simvis_run(), scene, "--quiet", "--frames", "5", "--threads", threads, "--out", out.string()}).wait();
    CHECK(run.err == "");
    REQUIRE(run.exit_code == 0);
    if (expected.empty()) expected = files_of(out);
    CHECK(expected.size() == 16);  // five of colour, five of depth, a table, intrinsics, poses of two sensors
    CHECK(files_of(out) == expected);
  }
}

// None of the sensors draws, because a driver has threads of its own.
TEST_CASE("with one thread, sensors that cast into worlds of their own start no other") {
  SimulationDesc desc;
  desc.threads = 1;
  const std::string pixels = " insert_at='ROOT' width='64' height='48' row_time='1e-4' rows_per_pose='16' ";
  Simulation simulation = Simulation::from_string(
      "<s><part name='WALL' insert_at='ROOT' shape='box' size='0.2 40 40' pose_offset='6 0 0 0 0 0'/>"
      "<part name='AT' insert_at='ROOT'/><element type='pose' name='MOVE' insert_at='AT'/>"
      "<part name='BOX' insert_at='AT' shape='box' size='1 1 1' pose_offset='3 0 0 0 0 0'/>"
      "<element type='label' name='L' insert_at='ROOT' part='BOX' class='box' class_id='9'/>"
      "<sensor type='camera' name='C' outputs='normal layers flow_backward flow_forward occlusion boxes silhouettes'" +
          pixels + "/><sensor type='camera' name='FIRST' outputs='depth normal' layer='first'" + pixels +
          "/><sensor type='keypoints' name='K'" + pixels +
          "/><sensor type='laser_scanner' name='S' insert_at='ROOT' samples='4000' sweep='0.01'/></s>",
      desc);
  const std::ptrdiff_t threads = threads_of_process();
  simulation.step();
  for (int frame = 0; frame < 3; ++frame) {
    simulation.set("MOVE", "y", 0.1 * frame);
    simulation.step();
  }
  CHECK(threads_of_process() == threads);
}

// Threads of the driver have names of their own or start in the first frame. So threads with the name of the process
// are counted after it, and the sphere, into which the scanner casts, is shown in the second frame.
TEST_CASE("with one thread, scanners that render cast into round shapes on no other") {
  const auto own_threads = [] {
    const std::string process = read_text("/proc/self/comm");
    std::ptrdiff_t count = 0;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
      count += read_text(task.path() / "comm") == process;
    }
    return count;
  };
  SimulationDesc desc;
  desc.threads = 1;
  Simulation simulation = Simulation::from_string(
      "<s><part name='WALL' insert_at='ROOT' shape='box' size='0.2 40 40' pose_offset='6 0 0 0 0 0'/>"
      "<part name='AT' insert_at='ROOT'/><element type='visibility' name='SHOW' insert_at='AT' visible='0'/>"
      "<part name='BALL' insert_at='AT' shape='sphere' radius='1' pose_offset='3 0 0 0 0 0'/>"
      "<sensor type='laser_scanner' name='S' insert_at='ROOT' method='planar' samples='4000'/></s>",
      desc);
  simulation.step();
  CHECK(simulation.diagnostics().frame_plan().threads == 1);
  const std::ptrdiff_t threads = own_threads();
  simulation.set("SHOW", "visible", 1);
  simulation.step();
  CHECK(own_threads() == threads);
  CHECK(simulation.scan("S").range_m[2000] < 3);  // the ball is seen, not the wall
}

TEST_CASE("--threads takes a whole number up to 1024") {
  const TemporaryFolder folder;
  const std::string scene = write_wall_scene(folder.path(), kThreadedSensors).string();
  for (const std::string threads : {"1025", "-1", "two", "4294967297"}) {
    CAPTURE(threads);
    const ProcessResult run =
        Process({simvis_run(), scene, "--threads", threads, "--out", (folder / "out").string()}).wait();
    CHECK(run.exit_code == 2);
    CHECK(run.err.find("--threads") != std::string::npos);
    CHECK(files_below(folder / "out").empty());
  }
}

}  // namespace simvis

TEST_SUITE_END();
