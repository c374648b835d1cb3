// Joints driven by a spring and a damper with an effort in addition, against the closed form of an oscillator.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/trigonometric.hpp>

#include "exchange/messages/types/sensor_types.h"
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kSlider_kg = 2, kServoEffort_n = 200;

// A mass that slides along z, and a bar of 1 m and 1 kg that turns about y at its end.
const std::string kServoUrdf =
    "<robot name='s'><link name='base'/><link name='slider'>" + inertial(kSlider_kg, "0 0 0", 0.1) +
    "</link><link name='bar'>" + inertial(1, "0.5 0 0", 1.0 / 12) +
    "</link><joint name='slide' type='prismatic'><parent link='base'/><child link='slider'/><axis xyz='0 0 1'/>"
    "<limit lower='-5' upper='5' effort='200' velocity='9'/></joint>"
    "<joint name='swing' type='revolute'><parent link='base'/><child link='bar'/><origin xyz='0 3 0'/>"
    "<axis xyz='0 1 0'/><limit lower='-3' upper='3' effort='200' velocity='9'/></joint></robot>";

MovingScene servo_scene(const std::string& attributes, const std::string& before = kPhysics) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "s.urdf") << kServoUrdf;
  return MovingScene(before +
                         "<part name='S' insert_at='ROOT' file='s.urdf'/>\n"
                         "<element type='robot' name='ROBOT' insert_at='S' " +
                         attributes + "/>",
                     folder.path());
}

TEST_CASE("a servo swings into its target as a damped oscillator, the same at any rate of frames") {
  constexpr double kStiffness = 200, kDamping = 8, kTarget_m = 0.5;
  const double decay = kDamping / (2 * kSlider_kg), w = std::sqrt(kStiffness / kSlider_kg - decay * decay);
  std::vector<double> first;
  for (const double period_s : {0.01, 0.05}) {
    MovingScene scene = servo_scene("control='servo' stiffness='200' damping='8'", physics("gravity='0 0 0'"));
    scene.set("ROBOT", "target_slide", kTarget_m);
    double time_s = 0;
    for (int i = 1; i <= 10; ++i) {
      scene.run(time_s, 0.1 * i, period_s);
      time_s = 0.1 * i;
      const double left = std::exp(-decay * time_s) * (std::cos(w * time_s) + decay / w * std::sin(w * time_s));
      // Semi-implicit steps of h move the swing by about w h of itself: 1 % at 10 / s.
      CHECK(std::abs(scene.get("slide", "value") - kTarget_m * (1 - left)) < 1.1 * w * kStep_s * kTarget_m);
    }
    if (first.empty()) first = scene.values();
    CHECK(scene.values() == first);
  }
}

TEST_CASE("a servo sags by weight / stiffness, and the feed-forward effort carries the weight") {
  // Soft ones act as efforts, the stiffest as constraints; at rest both have the same balance.
  for (const double stiffness : {400.0, 4e3, 1e7}) {
    CAPTURE(stiffness);
    const double damping = 2 * std::sqrt(stiffness * kSlider_kg);  // critical
    MovingScene scene = servo_scene("control='servo' stiffness='" + format_number(stiffness) + "' damping='" +
                                    format_number(damping) + "'");
    scene.run(0, 5, 0.1);
    const double weight_n = kSlider_kg * kGravity_m_s2;
    // After 5 s, e^-70 of the start is left.
    CHECK(std::abs(scene.get("slide", "value") + weight_n / stiffness) < 1e-9);
    // The bar: stiffness * angle = m g cos(angle) / 2, positive turns bring it down.
    const double angle = glm::radians(scene.get("swing", "value"));
    CHECK(std::abs(stiffness * angle - kGravity_m_s2 * 0.5 * std::cos(angle)) < 1e-6);
    scene.set("ROBOT", "effort_slide", weight_n);
    scene.set("ROBOT", "effort_swing", -kGravity_m_s2 * 0.5);
    scene.run(5, 10, 0.1);
    CHECK(std::abs(scene.get("slide", "value")) < 1e-9);
    CHECK(std::abs(scene.get("swing", "value")) < 1e-7);
  }
}

TEST_CASE("a servo without spring and damper is its effort alone, and no effort is above the joint's") {
  MovingScene scene = servo_scene("servo_joints='slide' control='none' stiffness='0'", physics("gravity='0 0 0'"));
  scene.set("ROBOT", "effort_slide", 3);
  scene.run(0, 1, 0.1);
  CHECK(std::abs(scene.get("slide", "value") - 3 / kSlider_kg * (1 + kStep_s) / 2) < 1e-12);
  // The target is far away: the effort is that of the file.
  MovingScene far = servo_scene("control='servo' stiffness='1e6'", physics("gravity='0 0 0'"));
  far.set("ROBOT", "target_slide", 5);
  far.set("ROBOT", "effort_slide", kServoEffort_n);
  far.run(0, 0.1, 0.1);
  CHECK(std::abs(far.get("slide", "value") - kServoEffort_n / kSlider_kg * (0.01 + 0.1 * kStep_s) / 2) < 1e-9);
}

TEST_CASE("a JointState message sets the feed-forward effort of servos, which ends with the timeout") {
  MovingScene scene = servo_scene(
      "control='servo' stiffness='10'/><element type='joint_command' name='COMMAND' insert_at='S' robot='ROBOT' "
      "topic='/targets'");
  const CommandInput input{"/targets", &ros::describe<ros::JointState>()};
  const auto state = [](double effort) { return ros::encode(ros::JointState{{}, {"slide"}, {0.25}, {}, {effort}}); };
  scene.command(input, state(7));
  scene.run(0, 0.4, 0.1);
  CHECK(scene.get("ROBOT", "effort_slide") == 7);
  CHECK(scene.get("ROBOT", "target_slide") == 0.25);
  CHECK(scene.get("ROBOT", "effort_swing") == 0);
  scene.run(0.4, 0.8, 0.1);
  CHECK(scene.get("ROBOT", "effort_slide") == 0);
  CHECK(scene.get("ROBOT", "target_slide") == 0.25);
  CHECK(contains(error_of([&] { scene.command(input, state(2 * kServoEffort_n)); }), "ROBOT.effort_slide"));
}

TEST_CASE("mistakes of servos are errors with their place") {
  const auto wrong = [](const std::string& attributes) { return error_of([&] { servo_scene(attributes); }); };
  CHECK(contains(wrong("control='servo'"), "is a servo, expected an attribute \"stiffness\""));
  CHECK(contains(wrong("control='servo' stiffness='-1'"), "stiffness"));
  CHECK(contains(wrong("control='servo' stiffness='1' damping='nan'"), "damping"));
  CHECK(contains(wrong("servo_joints='slide' position_joints='slide' stiffness='1'"), "expected it in one list"));
  CHECK(contains(wrong("servo_joints='slip' stiffness='1'"), "there is no joint \"slip\""));
  MovingScene scene = servo_scene("control='servo' stiffness='1'");
  CHECK(contains(error_of([&] { scene.set("ROBOT", "effort_slide", 2 * kServoEffort_n); }), "effort_slide"));
  CHECK(contains(error_of([&] { servo_scene("").set("ROBOT", "effort_slide", 1); }), "effort_slide"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
