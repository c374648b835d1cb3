// A vehicle turns the wheels of the robot that it drives, and joint_state reports them.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/trigonometric.hpp>
#include <optional>
#include <string>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kWheelRadius_m = 0.1;

std::string wheel(const std::string& name, const std::string& place, const std::string& axis,
                  const std::string& parent = "base") {
  return link_xml(name) +
         joint_xml(name + "_joint", "continuous", parent, name, "<origin " + place + "/><axis xyz='" + axis + "'/>");
}

// The axis of the left wheel lies along y because its frame is turned; that of the right one points to -y.
const std::string kCart =
    link_xml("base", "<visual><origin xyz='0 0 0.2'/><geometry><box size='0.5 0.3 0.1'/></geometry></visual>") +
    wheel("left", "xyz='0 0.2 0.1' rpy='-1.5707963267948966 0 0'", "0 0 1") +
    wheel("right", "xyz='0 -0.2 0.1'", "0 -1 0") + wheel("caster", "xyz='-0.2 0 0.05'", "0 0 1");

std::string cart_scene(const std::string& drive) {
  return "<simvis><element type='physics' name='PHYSICS' insert_at='ROOT'/>"
         "<part name='FLOOR' insert_at='ROOT' shape='box' size='100 100 1' pose_offset='0 0 -0.5 0 0 0'/>"
         "<element type='body' name='FLOOR_BODY' insert_at='FLOOR' kind='static' friction='1'/>"
         "<part file='cart.urdf' name='CART' insert_at='ROOT'/>"
         "<element type='vehicle' name='DRIVE' insert_at='CART' mass='10' clearance='0.05' " +
         drive + "/><sensor type='joint_state' name='JOINTS' insert_at='CART'/></simvis>";
}

struct Cart {
  explicit Cart(const std::string& drive, const std::string& robot_xml = kCart) {
    write_text(folder / "cart.urdf", robot(robot_xml));
    write_text(folder / "scene.xml", cart_scene(drive));
    SimulationDesc desc;
    desc.rate_hz = 20;
    simulation.emplace(Simulation::load(folder / "scene.xml", desc));
  }
  double joint(const std::string& name) const { return simulation->value("JOINTS", name + "_joint.position_rad"); }
  double speed(const std::string& name) const { return simulation->value("JOINTS", name + "_joint.velocity_rad_s"); }
  void step(int frames) {
    for (int i = 0; i < frames; ++i) simulation->step();
  }
  TemporaryFolder folder;
  std::optional<Simulation> simulation;
};

constexpr const char* kWheels = "left_joints='left_joint' right_joints='right_joint'";
// Wheels slip by what one step of friction leaves: some 1e-3 of the way, as docs/dynamics.md says.
constexpr double kSlip = 2e-3;

TEST_CASE("wheels turn by the way that they roll, about their own axes, and joint_state has their speeds") {
  Cart cart(kWheels);
  cart.simulation->set("DRIVE", "left", 180);
  cart.simulation->set("DRIVE", "right", 180);
  cart.step(20);
  const double from_m = cart.simulation->get("DRIVE", "x"), from_rad = cart.joint("left");
  const double other_rad = cart.joint("right");
  cart.step(40);
  const double way_m = cart.simulation->get("DRIVE", "x") - from_m;
  // 180 deg/s for 2 s: a turn.
  CHECK(std::abs(cart.joint("left") - from_rad - glm::radians(360.0)) <= kSlip * glm::radians(360.0));
  CHECK(std::abs(way_m - kWheelRadius_m * (cart.joint("left") - from_rad)) <= kSlip * way_m);
  CHECK(std::abs(cart.joint("right") - other_rad + (cart.joint("left") - from_rad)) <= kSlip * glm::radians(360.0));
  CHECK(std::abs(cart.speed("left") - glm::radians(180.0)) <= kSlip * glm::radians(180.0));
  CHECK(std::abs(cart.speed("right") + glm::radians(180.0)) <= kSlip * glm::radians(180.0));
  CHECK(cart.joint("caster") == 0);
}

TEST_CASE("without the attributes nothing turns, and a wheel that is set goes on from there") {
  Cart still("");
  still.simulation->set("DRIVE", "left", 180);
  still.step(20);
  CHECK(still.joint("left") == 0);
  Cart cart(kWheels);
  cart.simulation->set("DRIVE", "left", 180);
  cart.simulation->set("DRIVE", "right", 180);
  cart.step(20);
  cart.simulation->set("left_joint", "value", 1000);
  cart.step(20);
  CHECK(std::abs(cart.joint("left") - glm::radians(1000 + 180.0)) <= kSlip * glm::radians(180.0) + 1e-3);
}

TEST_CASE("an ackermann drive turns front wheels and forks") {
  const std::string car =
      link_xml("base", "<visual><origin xyz='0.3 0 0.2'/><geometry><box size='0.9 0.3 0.1'/></geometry></visual>") +
      wheel("rear_left", "xyz='0 0.2 0.1'", "0 1 0") + wheel("rear_right", "xyz='0 -0.2 0.1'", "0 1 0") +
      wheel("fork_left", "xyz='0.6 0.2 0.1'", "0 0 1") + wheel("fork_right", "xyz='0.6 -0.2 0.1'", "0 0 -1") +
      wheel("front_left", "xyz='0 0 0'", "0 1 0", "fork_left") +
      wheel("front_right", "xyz='0 0 0'", "0 1 0", "fork_right");
  Cart cart(
      "drive='ackermann' left_joints='rear_left_joint' right_joints='rear_right_joint' "
      "front_left_joints='front_left_joint' front_right_joints='front_right_joint' "
      "steer_left_joints='fork_left_joint' steer_right_joints='fork_right_joint'",
      car);
  cart.simulation->set("DRIVE", "speed", 90);
  cart.simulation->set("DRIVE", "steer", 10);
  cart.step(40);
  // Both forks turn towards one point on the line of the rear axle, at 0.6 / tan(10 deg) to the left.
  const double middle_m = 0.6 / std::tan(glm::radians(10.0));
  constexpr double kSettled_rad = 2e-3;  // of a drive by position against the friction of its wheel
  CHECK(std::abs(cart.joint("fork_left") - std::atan2(0.6, middle_m - 0.2)) <= kSettled_rad);
  CHECK(std::abs(cart.joint("fork_right") + std::atan2(0.6, middle_m + 0.2)) <= kSettled_rad);
  CHECK(cart.speed("rear_left") < cart.speed("rear_right"));
  // The front wheels roll: w at the radius of each about the middle of the turn.
  const double turn_rad_s = kWheelRadius_m * glm::radians(90.0) / middle_m;
  const double left_m = std::hypot(0.6, middle_m - 0.2), right_m = std::hypot(0.6, middle_m + 0.2);
  constexpr double kRolling = 0.01;  // a share: free wheels follow by friction
  CHECK(cart.speed("front_left") == doctest::Approx(turn_rad_s * left_m / kWheelRadius_m).epsilon(kRolling));
  CHECK(cart.speed("front_right") == doctest::Approx(turn_rad_s * right_m / kWheelRadius_m).epsilon(kRolling));
}

TEST_CASE("wheels that a vehicle turns have the efforts of its motors, and joints that nothing turns have none") {
  Cart cart(kWheels);
  cart.simulation->set("DRIVE", "left", 3600);  // so fast that they slip, which takes torque
  cart.simulation->set("DRIVE", "right", 3600);
  cart.step(2);                          // the first frame is at time 0
  constexpr double kMaxTorque_n_m = 20;  // of the element
  const double left = cart.simulation->value("JOINTS", "left_joint.effort_n_m");
  const double right = cart.simulation->value("JOINTS", "right_joint.effort_n_m");
  CHECK(left > 0);
  CHECK(left <= kMaxTorque_n_m);
  CHECK(right < 0);  // its axis points to the other side
  CHECK(right >= -kMaxTorque_n_m);
  CHECK_THROWS_AS(cart.simulation->value("JOINTS", "caster_joint.effort_n_m"), InputError);
}

TEST_CASE("wheels begin at their first angle again when the simulation restarts") {
  Cart cart(kWheels);
  cart.simulation->set("DRIVE", "left", 180);
  cart.step(5);
  const double once = cart.joint("left");
  cart.simulation->set("PHYSICS", "restarts", 1);
  cart.simulation->set("DRIVE", "left", 0);
  cart.simulation->set("DRIVE", "right", 0);
  cart.step(1);
  CHECK(once > 0.1);
  // At rest on its wheels, which settle into the floor without turning but for the friction of one step.
  CHECK(std::abs(cart.joint("left")) <= kSlip);
}

TEST_CASE("joints that are no wheels are refused with the attribute's place") {
  const auto refused = [](const std::string& drive, const std::string& robot_xml = kCart) {
    const std::string error = error_of([&] { Cart cart(drive, robot_xml); });
    CAPTURE(error);
    CHECK(contains(error, "scene.xml:1:" + std::to_string(cart_scene(drive).find(drive) + 1) + ":"));
    return error;
  };
  const std::string limited = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
  CHECK(contains(
      refused(
          "left_joints='left_joint'",
          link_xml("base", "<visual><origin xyz='0 0 0.2'/><geometry><box size='0.5 0.3 0.1'/></geometry></visual>") +
              link_xml("left") + joint_xml("left_joint", "revolute", "base", "left", "<axis xyz='0 1 0'/>" + limited)),
      "joint \"left_joint\" has limits, expected one that turns without end"));
  CHECK(contains(refused("left_joints='lefty'"), "there is no element \"lefty\" of type joint"));
  CHECK(contains(refused("left_joints='caster_joint'"), "does not turn about y of the part \"CART\""));
  const std::string twice = error_of([] { Cart cart("left_joints='left_joint' right_joints='left_joint'"); });
  CHECK(contains(twice, "is moved by another element"));
  CHECK(contains(refused("front_left_joints='left_joint'"), "for an ackermann drive"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
