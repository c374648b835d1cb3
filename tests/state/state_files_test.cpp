// --save-state and --restore-state: two runs together have the files of one.
#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include <simvis/simulation.h>
#include "tests/support/moving_scene.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("state");

namespace simvis::test {
namespace {

const std::string kFallingScene =
    kPhysics + ground() + body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.4 0 0 20'", "mass='1'") +
    "<sensor type='imu' name='IMU' insert_at='BOX'/>"
    "<sensor type='odometry' name='ODOM' insert_at='BOX' delay='0.1'/>";

struct Runs {
  TemporaryFolder folder;
  explicit Runs(const std::string& sensors = "") {
    std::ofstream(folder / "scene.xml") << "<simvis>" << kFallingScene << sensors << "</simvis>";
  }
  ProcessResult run(const std::string& out, Strings options) const {
    options.insert(options.end(), {"--quiet", "--out", (folder / out).string(), (folder / "scene.xml").string()});
    return run_simvis(options);
  }
  std::string state() const { return (folder / "s.state").string(); }
};

Strings rows_of(const std::filesystem::path& csv) {
  Strings rows;
  for (const Strings& row : read_csv(csv).rows) {
    std::string& line = rows.emplace_back();
    for (const std::string& cell : row) line += cell + ",";
  }
  return rows;
}

TEST_CASE("a run that goes on from a file writes the frames that follow") {
  const Runs runs(
      "<sensor type='event_camera' name='EVENTS' insert_at='BOX' width='8' height='8' leak='20'/>"
      "<sensor type='camera' name='FLOW' insert_at='BOX' width='8' height='8' outputs='flow_backward flow_forward'/>"
      "<sensor type='camera' name='SHOWN' insert_at='ROOT' width='8' height='8' view='visualization'/>"
      "<element type='trail' name='PATH' insert_at='ROOT' part='BOX'/>");
  REQUIRE(runs.run("whole", {"--frames", "12", "--set", "BOX_BODY.z=0.6"}).exit_code == 0);
  REQUIRE(runs.run("first", {"--frames", "5", "--set", "BOX_BODY.z=0.6", "--save-state", runs.state()}).exit_code == 0);
  const ProcessResult rest = runs.run("rest", {"--frames", "7", "--restore-state", runs.state()});
  CAPTURE(rest.err);
  REQUIRE(rest.exit_code == 0);
  for (const char* table : {"IMU.csv", "ODOM.csv", "EVENTS.csv"}) {
    Strings rows = rows_of(runs.folder / "first" / table);
    for (const std::string& row : rows_of(runs.folder / "rest" / table)) rows.push_back(row);
    CHECK(rows == rows_of(runs.folder / "whole" / table));
    CHECK(rows.size() > 8);
  }
}

TEST_CASE("a trajectory ends when it says, also behind a state with a frame of another length") {
  const Runs runs;
  Simulation simulation = Simulation::load(runs.folder / "scene.xml");
  simulation.step();
  simulation.step(std::chrono::milliseconds(700));
  std::ofstream(runs.state(), std::ios::binary) << simulation.save_state();
  std::ofstream(runs.folder / "drive.csv") << "time_s,BOX_BODY.z\n0,1\n1,1\n";
  const ProcessResult rest =
      runs.run("rest", {"--trajectory", (runs.folder / "drive.csv").string(), "--restore-state", runs.state()});
  CAPTURE(rest.err);
  REQUIRE(rest.exit_code == 0);
  int frames = 0;  // until 1 s
  for (; simulation.next_frame().time_ns <= 1'000'000'000; ++frames) simulation.step();
  CHECK(rows_of(runs.folder / "rest" / "IMU.csv").size() == static_cast<std::size_t>(frames));
}

TEST_CASE("what does not fit is an error of the option, and no file appears") {
  const Runs runs;
  std::ofstream(runs.state()) << "nothing";
  const ProcessResult wrong = runs.run("out", {"--restore-state", runs.state()});
  CHECK(wrong.exit_code == 2);
  CHECK(contains(wrong.err, "--restore-state " + runs.state() + ": these bytes are no state of a simulation"));
  const ProcessResult missing = runs.run("out", {"--restore-state", runs.state() + "x"});
  CHECK(missing.exit_code == 2);
  CHECK(contains(missing.err, "there is no such file"));
  const ProcessResult endless = runs.run("out", {"--restore-state", "/dev/zero"});
  CHECK(endless.exit_code == 2);
  CHECK(contains(endless.err, "is not a regular file"));
  const ProcessResult replaced = runs.run("out", {"--save-state", runs.state(), "--no-replace"});
  CHECK(replaced.exit_code == 2);
  CHECK(contains(replaced.err, "exists, and --no-replace is given"));
  std::filesystem::remove(runs.state());
  CHECK(runs.run("out", {"--restore-state", runs.state(), "--shard", "0/2"}).exit_code == 2);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
