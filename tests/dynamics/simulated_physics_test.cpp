// Physics in a whole simulation: skipped frames, followers, the exit status of simvis-run.
#include <doctest/doctest.h>
#include <unistd.h>

#include <string>

#include <simvis/simulation.h>
#include "program/cli/follower.h"
#include "tests/support/moving_scene.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

const std::string kFalling =
    "<simvis>" + kPhysics + body("BALL", "shape='sphere' radius='0.1' pose_offset='0 0 9 0 0 0'", "mass='1'") +
    "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='3' min_angle='-10' max_angle='10'/></simvis>";

TEST_CASE("bodies move through skipped frames, and the frames between are the same") {
  Simulation all = Simulation::from_string(kFalling), some = Simulation::from_string(kFalling);
  for (int frame = 0; frame < 6; ++frame) {
    all.step();
    frame % 3 == 2 ? some.step() : some.skip_frame();
  }
  CHECK(all.get("BALL_BODY", "z") < -0.4);
  CHECK(some.get("BALL_BODY", "z") == all.get("BALL_BODY", "z"));
}

TEST_CASE("a follower has the poses of the host's bodies and moves none itself") {
  const std::string name = "physics-" + std::to_string(::getpid());
  Simulation host = Simulation::from_string(kFalling);
  host.serve({.name = name});
  for (int frame = 0; frame < 4; ++frame) host.step();
  Follower follower(name, "", {});
  Simulation simulation = follower.open();
  for (int frame = 0; frame < 3; ++frame) {
    REQUIRE(follower.advance(simulation));
    follower.step(simulation);
    CHECK(simulation.get("BALL_BODY", "z") == host.get("BALL_BODY", "z"));
    host.step();
  }
  CHECK(host.get("BALL_BODY", "z") < -0.4);
}

TEST_CASE("simvis-run exits with 1 if bodies explode, and with 2 for a mistake") {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& xml) {
    write_text(folder.path() / "s.xml", xml);
    return run_simvis(
        {(folder.path() / "s.xml").string(), "--frames", "30", "--out", (folder.path() / "out").string()});
  };
  std::string fast = kFalling;
  fast.replace(fast.find("insert_at='ROOT'"), 0, "gravity='0 0 -9999' ");
  const ProcessResult exploded = run(fast);
  CHECK(exploded.exit_code == 1);
  CHECK(contains(exploded.err, "element \"BALL_BODY\" has exploded at 1.001 s"));
  CHECK(read_text(folder.path() / "out" / "SCAN.csv").find("nan") == std::string::npos);
  std::string lonely = kFalling;
  lonely.erase(lonely.find("<element type='physics'"), kPhysics.size());
  CHECK(run(lonely).exit_code == 2);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
