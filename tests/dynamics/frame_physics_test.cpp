// What a frame shows does not depend on the order of commands, and a frame of physics can be interrupted.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>

#include <simvis/simulation.h>
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

TEST_CASE("the order of bodies in a file does not change a heap") {
  const std::string lower = body("P", "shape='box' size='0.2 0.15 0.1' pose_offset='0 0 0.3 20 30 0'",
                                 "mass='1' shape='box'"),
                    upper = body("Q", "shape='box' size='0.2 0.15 0.1' pose_offset='0.05 0.02 0.5 50 10 0'",
                                 "mass='1' shape='box'");
  MovingScene a(kPhysics + ground() + lower + upper), b(kPhysics + upper + lower + ground());
  for (const double t : {0.3, 0.6, 1.0, 2.0}) {
    a.go_to(t);
    b.go_to(t);
    for (const char* const part : {"P", "Q"}) CHECK(a.pose(part) == b.pose(part));
  }
}

SimulationDesc slow_frames() {
  SimulationDesc desc;
  desc.rate_hz = 2;
  return desc;
}

TEST_CASE("encoders measure the velocity of a joint at the frame's time") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "p.urdf") << kPendulum;
  Simulation simulation =
      Simulation::from_string(kPhysics +
                                  "<part name='P' insert_at='ROOT' file='p.urdf'/>"
                                  "<element type='robot' name='SWING' insert_at='P' control='none'/>"
                                  "<sensor type='joint_state' name='J' insert_at='P'/>",
                              slow_frames(), folder.path());
  simulation.step();
  CHECK(simulation.value("J", "swing.velocity_rad_s") == 0);
  for (int frame = 1; frame < 5; ++frame) {
    simulation.step();
    const double angle = simulation.value("J", "swing.position_rad"),
                 speed = simulation.value("J", "swing.velocity_rad_s");
    // w^2 = 3 g sin(a) by energy. Steps keep an energy that differs by h / 2 of speed times gravity's moment.
    const double by_energy = std::sqrt(3 * kGravity_m_s2 * std::sin(angle));
    CHECK(std::abs(std::abs(speed) - by_energy) < 2 * kGravity_m_s2 * kStep_s);
    CHECK(std::abs(speed) > 0.1);
  }
}

TEST_CASE("a report of progress ends a long frame, and the next one goes on where it was") {
  struct Interrupted : std::runtime_error {
    using std::runtime_error::runtime_error;
  };
  const std::string scene = kPhysics +
                            body("A", "shape='box' size='1 1 1' pose_offset='0 0 50 0 0 0'",
                                 "mass='1' shape='box' angular_velocity='10 20 30'") +
                            "<sensor type='odometry' name='O' insert_at='A'/>";
  SimulationDesc desc = slow_frames();
  int reports = 0;
  desc.progress = [&](const Progress& progress) {
    if (progress.work != "physics") return;
    CHECK(progress.done <= progress.total);
    if (++reports == 2) throw Interrupted("stop");
  };
  Simulation stopped = Simulation::from_string(scene, desc), other = Simulation::from_string(scene, slow_frames());
  stopped.step();
  CHECK_THROWS_AS(stopped.step(), Interrupted);
  stopped.step();
  for (int frame = 0; frame < 2; ++frame) other.step();
  CHECK(reports > 2);
  for (const char* const column : {"x_m", "y_m", "z_m"}) CHECK(stopped.value("O", column) == other.value("O", column));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
