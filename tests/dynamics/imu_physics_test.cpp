// An imu on a body of physics measures the acceleration of the last step, whatever the rate of the frames.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <string>

#include <simvis/simulation.h>
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// Speeds of up to 30 m/s are rounded by 2^-53 of themselves some times in each step, and their difference is divided by
// its 1 ms; angles pass through degrees.
constexpr double kRounding_m_s2 = 1e-9;

SimulationDesc at_rate(double rate_hz) {
  SimulationDesc desc;
  desc.rate_hz = rate_hz;
  return desc;
}

glm::dvec3 force_of(Simulation& simulation) {
  return {simulation.value("IMU", "specific_force_x_m_s2"), simulation.value("IMU", "specific_force_y_m_s2"),
          simulation.value("IMU", "specific_force_z_m_s2")};
}

TEST_CASE("an imu in free fall feels nothing, at any rate") {
  for (const double rate_hz : {2.0, 15.0, 1000.0}) {
    CAPTURE(rate_hz);
    Simulation simulation = Simulation::from_string(
        kPhysics + body("BOX", "shape='box' size='0.4 0.3 0.2' pose_offset='0 0 90 10 20 30'", "shape='box' mass='3'") +
            "<sensor type='imu' name='IMU' insert_at='BOX' pose_offset='0.1 0.2 0.3 40 50 60'/>",
        at_rate(rate_hz));
    simulation.step();  // before the first step of physics
    for (int frame = 0; frame < 5; ++frame) {
      simulation.step();
      CHECK(glm::length(force_of(simulation)) < kRounding_m_s2);
    }
  }
}

TEST_CASE("an imu off the axis of a spinning body feels the centripetal force of one step, where frames turn it far") {
  constexpr double kTurn_rad_s = 5, kLever_m = 0.5;
  Simulation simulation = Simulation::from_string(
      physics("gravity='0 0 0'") +
          body("TOP", "shape='box' size='0.2 0.2 0.2'",
               "shape='box' mass='1' angular_velocity='0 0 " + format_number(glm::degrees(kTurn_rad_s)) + "'") +
          "<sensor type='imu' name='IMU' insert_at='TOP' pose_offset='0.5 0 0 0 0 0' gravity='0 0 0'/>",
      at_rate(2));  // 2.5 rad in a frame
  simulation.step();
  for (int frame = 0; frame < 4; ++frame) {
    simulation.step();
    // The mean over a step that turns by 2 x and ends at the sensor's place: w^2 r sin(x) / x, from the place half a
    // step before.
    const double x = kTurn_rad_s * kStep_s / 2, mean = kTurn_rad_s * kTurn_rad_s * kLever_m * std::sin(x) / x;
    const glm::dvec3 expected(-mean * std::cos(x), mean * std::sin(x), 0);
    CHECK(glm::length(force_of(simulation) - expected) < kRounding_m_s2);
  }
}

TEST_CASE("an imu on a link of a robot feels that link's step") {
  // The bar swings from rest at the horizontal; its tip at 1 m has the angular acceleration 3 g cos(a) / 2 and the
  // speed w^2 = 3 g sin(a), by the energy of a bar of 1 m.
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "p.urdf") << kPendulum;
  Simulation simulation =
      Simulation::from_string(kPhysics +
                                  "<part name='P' insert_at='ROOT' file='p.urdf'/>"
                                  "<element type='robot' name='SWING' insert_at='P' control='none'/>"
                                  "<sensor type='imu' name='IMU' insert_at='bar' pose_offset='1 0 0 0 0 0'/>",
                              at_rate(10), folder.path());
  simulation.step();
  for (int frame = 1; frame <= 5; ++frame) {
    simulation.step();
    glm::dmat4 tip;
    REQUIRE(simulation.sensor_pose("IMU", tip));
    const double angle = std::atan2(-tip[0].z, tip[0].x), w_2 = 3 * kGravity_m_s2 * std::sin(angle);
    const double turn = 1.5 * kGravity_m_s2 * std::cos(angle);  // downwards: along -z of the sensor
    // Specific force: acceleration less gravity, which lies at sin(a) along x and -cos(a) along z.
    const glm::dvec3 expected(-w_2 - kGravity_m_s2 * std::sin(angle), 0, -turn + kGravity_m_s2 * std::cos(angle));
    // Semi-implicit steps are half a step late or early: accelerations of up to 3 g change by up to 3 g w in a second.
    const double w = std::sqrt(w_2), late = 2 * 3 * kGravity_m_s2 * std::max(w, 1.0) * kStep_s;
    CHECK(glm::length(force_of(simulation) - expected) < late);
  }
}

TEST_CASE("an imu that does not move with the body, or moves on it, feels its own motion") {
  // In front of the body's element the imu stands still; its weight is what it feels.
  Simulation stands = Simulation::from_string(
      kPhysics +
          "<part name='BOX' insert_at='ROOT' shape='box' size='1 1 1' pose_offset='0 0 50 0 0 0'/>"
          "<sensor type='imu' name='IMU' insert_at='BOX'/>"
          "<element type='body' name='BOX_BODY' insert_at='BOX' shape='box' mass='1'/>",
      at_rate(10));
  for (int frame = 0; frame < 5; ++frame) {
    stands.step();
    CHECK(glm::length(force_of(stands) - glm::dvec3(0, 0, kGravity_m_s2)) < kRounding_m_s2);
  }
  // On a body that floats, an element moves the imu: x = t^2 / 2 at 10 Hz, whose second difference is 1 m/s2.
  Simulation moves = Simulation::from_string(
      physics("gravity='0 0 0'") + body("BOX", "shape='box' size='1 1 1'", "shape='box' mass='1'") +
          "<part name='SLED' insert_at='BOX'/><element type='pose' name='MOVE' insert_at='SLED'/>"
          "<sensor type='imu' name='IMU' insert_at='SLED' gravity='0 0 0'/>",
      at_rate(10));
  for (int frame = 0; frame < 5; ++frame) {
    moves.set("MOVE", "x", 0.005 * frame * frame);
    moves.step();
    if (frame > 1) CHECK(glm::length(force_of(moves) - glm::dvec3(1, 0, 0)) < kRounding_m_s2);
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
