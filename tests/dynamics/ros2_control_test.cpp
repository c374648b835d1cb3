// Commands of joints as hardware interfaces and controllers of ros2_control send them.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <glm/trigonometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/std_types.h"
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// An arm with a gripper whose second finger follows the first, on two wheels.
std::string mobile_arm() {
  std::string links = "<robot name='m'><link name='base'/>", joints;
  const auto add = [&](const std::string& joint, const std::string& type, const std::string& more) {
    links += "<link name='" + joint + "_link'>" + inertial(1, "0 0 0", 0.1) + "</link>";
    joints += "<joint name='" + joint + "' type='" + type + "'><parent link='base'/><child link='" + joint +
              "_link'/><axis xyz='0 0 1'/><limit lower='-2' upper='2' effort='50' velocity='10'/>" + more + "</joint>";
  };
  add("left_wheel", "continuous", "");
  add("right_wheel", "continuous", "");
  add("shoulder", "revolute", "");
  add("finger_1", "prismatic", "");
  add("finger_2", "prismatic", "<mimic joint='finger_1' multiplier='-1'/>");
  add("motor", "revolute", "");
  return links + joints + "</robot>";
}

MovingScene mobile_scene(const std::string& command = "") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "m.urdf") << mobile_arm();
  return MovingScene(physics("gravity='0 0 0'") +
                         "<part name='M' insert_at='ROOT' file='m.urdf'/>\n"
                         "<element type='robot' name='ROBOT' insert_at='M' velocity_joints='left_wheel right_wheel' "
                         "effort_joints='motor'/>\n"
                         "<element type='joint_command' name='COMMAND' insert_at='M' robot='ROBOT' " +
                         command + "/>",
                     folder.path());
}

const std::vector<std::string> kHardware = {"left_wheel", "right_wheel", "shoulder", "finger_1", "finger_2", "motor"};

void send(MovingScene& scene, const ros::JointState& state) {
  scene.command({"/COMMAND/joint_commands", &ros::describe<ros::JointState>()}, ros::encode(state));
}
void check_targets(MovingScene& scene, double time_s, double left, double right, double shoulder, double finger,
                   double motor) {
  constexpr double kRounding_deg = 1e-12;  // of some hundred degrees
  scene.go_to(time_s);
  CHECK(std::abs(scene.get("ROBOT", "target_left_wheel") - glm::degrees(left)) < kRounding_deg);
  CHECK(std::abs(scene.get("ROBOT", "target_right_wheel") - glm::degrees(right)) < kRounding_deg);
  CHECK(std::abs(scene.get("ROBOT", "target_shoulder") - glm::degrees(shoulder)) < kRounding_deg);
  CHECK(scene.get("ROBOT", "target_finger_1") == finger);
  CHECK(scene.get("ROBOT", "target_motor") == motor);
}

TEST_CASE("a JointState with all joints of the hardware sets those that are driven, in full and in compact lists") {
  MovingScene scene = mobile_scene();
  // One number for each name; those of other kinds, and of the finger that follows, say nothing.
  send(scene, {{}, kHardware, {9, 9, 0.5, 0.25, 9, 9}, {1, -2, 9, 9, 9, 9}, {9, 9, 9, 9, 9, 3}});
  check_targets(scene, 0.1, 1, -2, 0.5, 0.25, 3);
  // Lists of the joints with this command interface only.
  send(scene, {{}, kHardware, {-0.5, 0.125}, {4, 5}, {-6}});
  check_targets(scene, 0.2, 4, 5, -0.5, 0.125, -6);
  // Both kinds of lists in one message.
  send(scene, {{}, kHardware, {0, 0, 0.75, 0, 0, 0}, {1, 2}, {7}});
  check_targets(scene, 0.3, 1, 2, 0.75, 0, 7);
  scene.go_to(0.9);
  scene.go_to(1);  // speeds and efforts end with the timeout
  CHECK(scene.get("ROBOT", "target_left_wheel") == 0);
  CHECK(scene.get("ROBOT", "target_motor") == 0);
  CHECK(std::abs(scene.get("ROBOT", "target_shoulder") - glm::degrees(0.75)) < 1e-12);
}

TEST_CASE("lists that fit neither way are refused, and nothing changes") {
  MovingScene scene = mobile_scene();
  const auto refused = [&](const ros::JointState& state) { return error_of([&] { send(scene, state); }); };
  CHECK(contains(refused({{}, kHardware, {1, 1, 1}, {1, 1}, {1}}),
                 "a list has 3 values for 6 joints, of which 2 are driven by position"));
  CHECK(contains(refused({{}, kHardware, {1, 1}, {}, {1}}), "is driven by velocity, expected values of that kind"));
  CHECK(contains(refused({{}, {"shoulder", "elbow"}, {1, 1}, {}, {}}), "there is no driven joint \"elbow\""));
  CHECK(contains(refused({{}, {"shoulder", "shoulder"}, {1, 1}, {}, {}}), "comes twice"));
  CHECK(contains(refused({{}, {"finger_2", "shoulder", "finger_2"}, {1, 1, 1}, {}, {}}), "\"finger_2\" comes twice"));
  CHECK(contains(refused({{}, kHardware, {1, 5}, {1, 1}, {1}}), "finger_1"));  // 5 m
  scene.go_to(0.1);
  CHECK(scene.get("ROBOT", "target_shoulder") == 0);
}

TEST_CASE("a JointState with joints that only follow belongs to their robot") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "m.urdf") << mobile_arm();
  std::ofstream(folder.path() / "arm.urdf")
      << "<robot name='a'><link name='a'>" + inertial(1, "0 0 0", 0.1) + "</link><link name='b'>" +
             inertial(1, "0 0 0", 0.1) +
             "</link><joint name='elbow' type='continuous'><parent link='a'/><child link='b'/></joint></robot>";
  std::string commands = physics("gravity='0 0 0'");
  for (const std::string name : {"ARM", "M"}) {
    commands += "<part name='" + name + "' insert_at='ROOT' file='" + (name == "M" ? "m" : "arm") +
                ".urdf'/>\n<element type='robot' name='ROBOT_" + name + "' insert_at='" + name +
                "'/>\n<element type='joint_command' name='COMMAND_" + name + "' insert_at='" + name +
                "' robot='ROBOT_" + name + "' topic='/COMMAND/joint_commands'/>\n";
  }
  MovingScene scene(commands, folder.path());
  CHECK_NOTHROW(send(scene, {{}, {"finger_2"}, {0.1}, {}, {}}));
}

TEST_CASE("a Float64MultiArray sets the targets of the listed joints, each of its kind") {
  const auto values = [](MovingScene& scene, const std::string& topic, const std::vector<double>& data) {
    scene.command({topic, &ros::describe<ros::Float64MultiArray>()}, ros::encode(ros::Float64MultiArray{{}, data}));
  };
  MovingScene all = mobile_scene();
  // The parameters of a robot from URDF are in the order of the names: finger_1, left_wheel, motor, right_wheel,
  // shoulder.
  values(all, "/COMMAND/commands", {0.25, 1, 3, 2, 0.5});
  check_targets(all, 0.1, 1, 2, 0.5, 0.25, 3);
  CHECK(contains(error_of([&] { values(all, "/COMMAND/commands", {1, 2}); }), "has 2 values, expected 5"));
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  CHECK(contains(error_of([&] { values(all, "/COMMAND/commands", {0, 0, kNan, 0, 0}); }), "not finite"));
  CHECK(contains(error_of([&] { values(all, "/COMMAND/commands", {0, 0, 0, 0, 9}); }), "shoulder"));

  MovingScene some = mobile_scene("joints='motor shoulder' values_topic='/arm/commands'");
  values(some, "/arm/commands", {-4, 1});
  check_targets(some, 0.1, 0, 0, 1, 0, -4);
  CHECK(contains(error_of([] { mobile_scene("joints='shoulder elbow'"); }), "there is no driven joint \"elbow\""));
  CHECK(contains(error_of([] { mobile_scene("joints='shoulder shoulder'"); }), "comes twice"));
  CHECK(contains(error_of([] { mobile_scene("joints='finger_2'"); }), "there is no driven joint \"finger_2\""));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
