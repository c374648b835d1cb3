// The effort of drives in a sensor `joint_state`, against weights and limits, and joints that follow others.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include <simvis/simulation.h>
#include "exchange/messages/from_reading.h"
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kLift_kg = 2, kLiftEffort_n = 200, kBar_kg = 1, kBarLever_m = 0.5;

// The passes end once no speed changes by more than this in one of them.
constexpr double kSolverResidual_m_s = 1e-8;
constexpr double kLiftResidual_n = kLift_kg * kSolverResidual_m_s / kStep_s;
constexpr double kBarResidual_nm = (kBar_kg / 12 + kBar_kg * kBarLever_m * kBarLever_m) * kSolverResidual_m_s / kStep_s;

// A mass that slides along z, a bar of 1 m that turns about y at its end, and a finger that follows the mass.
std::string lift_urdf(double friction_n) {
  return "<robot name='s'><link name='base'/><link name='load'>" + inertial(kLift_kg, "0 0 0", 0.1) +
         "</link><link name='bar'>" + inertial(kBar_kg, "0.5 0 0", kBar_kg / 12) + "</link><link name='finger'>" +
         inertial(0.1, "0 0 0", 0.1) +
         "</link><joint name='lift' type='prismatic'><parent link='base'/><child link='load'/><axis xyz='0 0 1'/>"
         "<dynamics damping='0' friction='" +
         format_number(friction_n) +
         "'/><limit lower='-50' upper='50' effort='200' velocity='90'/></joint>"
         "<joint name='swing' type='revolute'><parent link='base'/><child link='bar'/><origin xyz='0 3 0'/>"
         "<axis xyz='0 1 0'/><limit lower='-3' upper='3' effort='200' velocity='9'/></joint>"
         "<joint name='grip' type='prismatic'><parent link='base'/><child link='finger'/><origin xyz='0 6 0'/>"
         "<axis xyz='1 0 0'/><limit lower='-50' upper='50' effort='200' velocity='90'/>"
         "<mimic joint='lift' multiplier='-0.5' offset='0.25'/></joint></robot>";
}

Simulation lift(const std::string& robot, double rate_hz, const std::string& physics_attributes = "",
                double friction_n = 0) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "s.urdf") << lift_urdf(friction_n);
  SimulationDesc desc;
  desc.rate_hz = rate_hz;
  return Simulation::from_string(physics(physics_attributes) +
                                     "<part name='S' insert_at='ROOT' file='s.urdf'/>"
                                     "<element type='robot' name='ROBOT' insert_at='S' " +
                                     robot + "/><sensor type='joint_state' name='J' insert_at='S'/>",
                                 desc, folder.path());
}

void run_until(Simulation& simulation, double time_s, double rate_hz) {
  for (int frame = 0; frame <= std::lround(time_s * rate_hz); ++frame) simulation.step();
}

TEST_CASE("each drive that holds a weight has the weight as its effort, at any rate of frames") {
  const char* const drives[] = {"control='position'", "control='velocity'",
                                "control='servo' stiffness='400' damping='60'",    // acts as an effort
                                "control='servo' stiffness='1e7' damping='1e4'"};  // acts as a constraint
  for (const char* const drive : drives) {
    CAPTURE(drive);
    double first = 0;
    for (const double rate_hz : {5.0, 50.0}) {
      CAPTURE(rate_hz);
      Simulation simulation = lift(drive, rate_hz);
      run_until(simulation, 4, rate_hz);
      CHECK(std::abs(simulation.value("J", "lift.effort_n") - kLift_kg * kGravity_m_s2) < kLiftResidual_n);
      // A positive turn brings the bar down.
      const double angle = simulation.value("J", "swing.position_rad");
      CHECK(std::abs(simulation.value("J", "swing.effort_n_m") +
                     kBar_kg * kGravity_m_s2 * kBarLever_m * std::cos(angle)) < kBarResidual_nm);
      if (first == 0) first = simulation.value("J", "lift.effort_n");
      CHECK(simulation.value("J", "lift.effort_n") == first);
    }
  }
}

TEST_CASE("a drive that accelerates as fast as it can has the largest effort") {
  constexpr double kRounding = 1e-12;  // of the effort, by the product with the step and the quotient
  for (const char* const drive : {"control='velocity'", "control='servo' stiffness='1e7'", "control='position'"}) {
    CAPTURE(drive);
    Simulation simulation = lift(drive, 100, "gravity='0 0 0'");
    simulation.set("ROBOT", "target_lift", 40);
    run_until(simulation, 0.1, 100);
    CHECK(std::abs(simulation.value("J", "lift.effort_n") / kLiftEffort_n - 1) < kRounding);
    CHECK(simulation.value("J", "lift.velocity_m_s") > 9);  // 100 m/s^2 for 0.1 s, a step less
  }
}

TEST_CASE("an effort is its target, a soft servo spring and damper, and a joint without a drive has 0") {
  constexpr double kStiffness = 50, kDamping = 4, kTarget_m = 2;
  Simulation effort = lift("control='effort'", 10);
  effort.set("ROBOT", "target_lift", 7.25);
  run_until(effort, 0.5, 10);
  CHECK(effort.value("J", "lift.effort_n") == 7.25);
  CHECK(effort.value("J", "swing.effort_n_m") == 0);

  // Frames of one step: the effort follows from the state of the frame before.
  Simulation servo = lift("control='servo' stiffness='50' damping='4'", 1000);
  servo.set("ROBOT", "target_lift", kTarget_m);
  servo.set("ROBOT", "effort_lift", 3);
  run_until(servo, 0.2, 1000);
  const double position_m = servo.value("J", "lift.position_m"), speed_m_s = servo.value("J", "lift.velocity_m_s");
  servo.step();
  CHECK(speed_m_s > 0.1);
  CHECK(std::abs(servo.value("J", "lift.effort_n") -
                 (kStiffness * (kTarget_m - position_m) - kDamping * speed_m_s + 3)) < 1e-12);

  // The friction of 3 N slows the mass down, and is no drive.
  Simulation none = lift("control='none'", 10, "", 3);
  run_until(none, 0.5, 10);
  CHECK(std::abs(none.value("J", "lift.velocity_m_s") + (kGravity_m_s2 - 3 / kLift_kg) * 0.5) < 1e-9);
  CHECK(none.value("J", "lift.effort_n") == 0);
  CHECK(none.value("J", "swing.effort_n_m") == 0);
}

TEST_CASE("before the first step the effort is 0") {
  Simulation simulation = lift("control='position'", 10);
  simulation.step();
  CHECK(simulation.value("J", "lift.effort_n") == 0);
}

TEST_CASE("a joint that follows another one is measured, and has no effort") {
  Simulation simulation = lift("control='velocity'", 10, "gravity='0 0 0'");
  simulation.set("ROBOT", "target_lift", 2);
  run_until(simulation, 1, 10);
  const double position_m = simulation.value("J", "lift.position_m"),
               speed_m_s = simulation.value("J", "lift.velocity_m_s");
  CHECK(position_m > 1.9);
  CHECK(simulation.value("J", "grip.position_m") == -0.5 * position_m + 0.25);
  CHECK(simulation.value("J", "grip.velocity_m_s") == -0.5 * speed_m_s);
  CHECK_FALSE(simulation.find_value("J", "grip.effort_n"));

  const auto made = ros::message_of(simulation.reading("J"), ros::JointState::kName, "base");
  REQUIRE(made);
  const auto& message = std::get<ros::JointState>(made->message);
  REQUIRE(message.effort.size() == message.name.size());
  REQUIRE(message.name.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string& name = message.name[i];
    CHECK(std::isnan(message.effort[i]) == (name == "grip"));
    if (name == "lift") CHECK(message.effort[i] == simulation.value("J", "lift.effort_n"));
    if (name == "swing") CHECK(message.effort[i] == simulation.value("J", "swing.effort_n_m"));
  }
}

TEST_CASE("joints that no physics moves have no effort, in columns and message") {
  Simulation simulation = Simulation::from_string(
      "<part name='P' insert_at='ROOT'/><element type='joint' name='A' insert_at='P' axis='0 0 1' value='90'/>"
      "<element type='mimic_joint' name='B' insert_at='P' leader='A' kind='prismatic' multiplier='0.01' offset='2'/>"
      "<sensor type='joint_state' name='J' insert_at='P'/>");
  simulation.step();
  simulation.set("A", "value", 120);
  simulation.step();
  CHECK(std::abs(simulation.value("J", "B.position_m") - 3.2) < 1e-15);
  // 30 degrees in a frame of 1/15 s.
  CHECK(std::abs(simulation.value("J", "B.velocity_m_s") - 0.01 * 30 * 15) < 1e-6);
  CHECK(simulation.reading("J").arrays.size() == 4);
  const auto made = ros::message_of(simulation.reading("J"), ros::JointState::kName, "base");
  REQUIRE(made);
  CHECK(std::get<ros::JointState>(made->message).effort.empty());
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
