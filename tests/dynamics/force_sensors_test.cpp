// The sensors contact and force_torque against weights and levers.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <glm/trigonometric.hpp>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// What stands trembles: its speed changes by less than this in a step, of the g h that gravity brings.
constexpr double kTremble = 1e-3;

struct Sum {
  double force_n = 0;
  glm::dvec3 place_m{0}, normal{0};  // means by force
  double deepest_m = 0;
};

Sum sum_of(const Reading& reading) {
  Sum sum;
  for (std::size_t row = 0; row < reading.rows(); ++row) {
    const double* const v = &reading.values()[row * reading.arrays.size()];
    sum.force_n += v[7];
    sum.place_m += v[7] * glm::dvec3(v[0], v[1], v[2]);
    sum.normal += v[7] * glm::dvec3(v[3], v[4], v[5]);
    sum.deepest_m = std::max(sum.deepest_m, v[6]);
  }
  sum.place_m /= sum.force_n;
  sum.normal /= sum.force_n;
  return sum;
}

struct Load {
  glm::dvec3 force_n, torque_nm;
};
Load load_of(Simulation& simulation, const char* sensor) {
  const auto value = [&](const char* name) { return simulation.value(sensor, name); };
  return {{value("force_x_n"), value("force_y_n"), value("force_z_n")},
          {value("torque_x_n_m"), value("torque_y_n_m"), value("torque_z_n_m")}};
}

void run(Simulation& simulation, int frames) {
  for (int i = 0; i < frames; ++i) simulation.step();
}

TEST_CASE("the contacts of a box at rest carry its weight below its centre of mass") {
  // The sensor is turned by 90 degrees about z: its x is the box's y, its y the box's -x.
  Simulation simulation =
      Simulation::from_string(kPhysics + ground() +
                              body("BOX", "shape='box' size='0.4 0.3 0.2' pose_offset='1 2 0.1 0 0 0'",
                                   "shape='box' mass='3' center='0.1 0.05 0' inertia='0.03 0.05 0.06'") +
                              "<sensor type='contact' name='C' insert_at='BOX' pose_offset='0 0 0 0 0 90'/>"
                              "<sensor type='contact' name='FLOOR' insert_at='GROUND'/>");
  run(simulation, 30);
  const Sum box = sum_of(simulation.reading("C")), floor = sum_of(simulation.reading("FLOOR"));
  const double weight_n = 3 * kGravity_m_s2;
  CHECK(std::abs(box.force_n - weight_n) < kTremble * weight_n);
  CHECK(floor.force_n == box.force_n);
  // The share that trembles may act at an edge, 0.3 m from the centre of mass.
  const double place_m = kTremble * 0.3 + 1e-6;
  CHECK(std::abs(box.place_m.x - 0.05) < place_m);
  CHECK(std::abs(box.place_m.y + 0.1) < place_m);
  CHECK(std::abs(box.place_m.z + 0.1) < 1e-4);  // as deep as boxes rest in each other
  CHECK(glm::length(box.normal - glm::dvec3(0, 0, 1)) < 1e-4);
  CHECK(glm::length(floor.normal - glm::dvec3(0, 0, -1)) < 1e-4);
  CHECK(box.deepest_m < 1e-4);
  CHECK(std::abs(floor.place_m.x - 1.1) < place_m);
}

// The name of the object of an id.
std::string object_named(const Simulation& simulation, double id) {
  for (const SceneObject& object : simulation.objects()) {
    if (object.instance == id) return object.path;
  }
  return "";
}

// Each pair of objects that a sensor of contacts has found, as "own/other".
std::set<std::string> touching(const Simulation& simulation, const std::string& sensor) {
  const Reading& reading = simulation.reading(sensor);
  std::set<std::string> pairs;
  for (std::size_t row = 0; row < reading.rows(); ++row) {
    pairs.insert(object_named(simulation, *reading.find("own_instance", row)) + " on " +
                 object_named(simulation, *reading.find("other_instance", row)));
  }
  return pairs;
}

TEST_CASE("contacts name the objects that touch, from both sides") {
  Simulation simulation = Simulation::from_string(
      kPhysics + ground() + body("LOW", "shape='box' size='0.4 0.4 0.2' pose_offset='0 0 0.1 0 0 0'", "mass='3'") +
      body("HIGH", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.3 0 0 0'", "mass='1'") +
      "<sensor type='contact' name='L' insert_at='LOW'/>"
      "<sensor type='contact' name='H' insert_at='HIGH'/>"
      "<sensor type='contact' name='G' insert_at='GROUND'/>");
  run(simulation, 5);
  CHECK(touching(simulation, "L") == std::set<std::string>{"LOW on GROUND", "LOW on HIGH"});
  CHECK(touching(simulation, "H") == std::set<std::string>{"HIGH on LOW"});
  CHECK(touching(simulation, "G") == std::set<std::string>{"GROUND on LOW"});
}

TEST_CASE("contacts of a robot name its links by their paths") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "robot.urdf")
      << "<robot name='r'><link name='base'>" + inertial(1, "0 0 0", 0.02) +
             "<collision><geometry><box size='0.4 0.4 0.1'/></geometry></collision></link><link name='tray'>" +
             inertial(1, "0 0 0", 0.02) +
             "<collision><geometry><box size='0.2 0.2 0.1'/></geometry></collision></link>"
             "<joint name='j' type='prismatic'><parent link='base'/><child link='tray'/><origin xyz='0.4 0 0'/>"
             "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='500' velocity='1'/></joint></robot>";
  Simulation simulation =
      Simulation::from_string(kPhysics + ground() +
                                  "<part name='BOT' insert_at='ROOT' file='robot.urdf' pose_offset='0 0 0.05 0 0 0'/>"
                                  "<element type='robot' name='DRIVE' insert_at='BOT' base='free'/>"
                                  "<sensor type='contact' name='TRAY' insert_at='tray'/>"
                                  "<sensor type='contact' name='G' insert_at='GROUND'/>",
                              {}, folder.path());
  run(simulation, 5);
  CHECK(touching(simulation, "TRAY") == std::set<std::string>{"BOT/tray on GROUND"});
  CHECK(touching(simulation, "G") == std::set<std::string>{"GROUND on BOT/base", "GROUND on BOT/tray"});
}

TEST_CASE("what flies touches nothing, and a part without a body is an error") {
  Simulation simulation = Simulation::from_string(
      kPhysics + ground() + body("BALL", "shape='sphere' radius='0.1' pose_offset='0 0 5 0 0 0'", "mass='1'") +
      "<sensor type='contact' name='C' insert_at='BALL'/>");
  run(simulation, 3);
  CHECK(simulation.reading("C").rows() == 0);
  CHECK(contains(error_of([] {
                   Simulation lonely = Simulation::from_string(
                       "<part name='A' insert_at='ROOT' shape='box' size='1 1 1'/>"
                       "<sensor type='contact' name='C' insert_at='A'/>");
                   lonely.step();
                 }),
                 "sensor \"C\": no body of physics stands at \"A\", expected"));
}

// A table on two legs: 4 kg above, 1 kg each leg, whose lower ends are at z = -0.5.
Simulation table(const std::string& attributes) {
  const auto leg = [](const std::string& name, const std::string& y) {
    return "<link name='" + name + "'>" + inertial(1, "0 0 -0.25", 0.02) +
           "<collision><origin xyz='0 0 -0.25'/><geometry><box size='0.4 0.1 0.5'/></geometry></collision></link>"
           "<joint name='j_" +
           name + "' type='revolute'><parent link='top'/><child link='" + name + "'/><origin xyz='0 " + y +
           " 0'/><axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='500' velocity='1'/></joint>";
  };
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "table.urdf") << "<robot name='t'><link name='top'>" + inertial(4, "0 0 0", 0.5) +
                                                     "</link>" + leg("left", "0.4") + leg("right", "-0.4") + "</robot>";
  std::ofstream(folder.path() / "s.xml")
      << "<simvis>" + physics(attributes) + ground() +
             "<part name='T' insert_at='ROOT' file='table.urdf' pose_offset='0 0 0.5 0 0 0'/>"
             "<element type='robot' name='TABLE' insert_at='T' base='free'/>"
             "<sensor type='contact' name='L' insert_at='left'/>"
             "<sensor type='contact' name='ALL' insert_at='T'/><sensor type='contact' name='TOP' insert_at='top'/>"
             "<sensor type='force_torque' name='LEFT' insert_at='GROUND' joint='j_left'/>"
             "<sensor type='force_torque' name='RIGHT' insert_at='GROUND' joint='j_right'/></simvis>";
  Simulation simulation = Simulation::load(folder.path() / "s.xml");
  run(simulation, 30);
  return simulation;
}

TEST_CASE("links of a robot have contacts of their own") {
  const Simulation simulation = table("");
  const double weight_n = 6 * kGravity_m_s2;
  CHECK(std::abs(sum_of(simulation.reading("ALL")).force_n - weight_n) < 10 * kTremble * weight_n);
  CHECK(std::abs(sum_of(simulation.reading("L")).force_n - weight_n / 2) < 10 * kTremble * weight_n);
  CHECK(simulation.reading("TOP").rows() == 0);
}

TEST_CASE("joints between two bodies that touch the floor carry what is above") {
  Simulation simulation = table("");
  const glm::dvec3 both = load_of(simulation, "LEFT").force_n + load_of(simulation, "RIGHT").force_n;
  CHECK(std::abs(both.z - 4 * kGravity_m_s2) < 10 * kTremble * 4 * kGravity_m_s2);
}

Simulation arm(const std::string& urdf, const std::string& attributes, const std::string& sensors, double rate_hz) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "robot.urdf") << urdf;
  std::ofstream(folder.path() / "s.xml")
      << "<simvis>" + kPhysics +
             "<part name='R' insert_at='ROOT' file='robot.urdf' pose_offset='0 0 2 0 0 0'/>"
             "<element type='robot' name='ROBOT' insert_at='R' " +
             attributes + "/>" + sensors + "</simvis>";
  SimulationDesc desc;
  desc.rate_hz = rate_hz;
  return Simulation::load(folder.path() / "s.xml", desc);
}

const std::string kArmSensors =
    "<sensor type='force_torque' name='SHOULDER' insert_at='upper' joint='shoulder'/>"
    "<sensor type='force_torque' name='ELBOW' insert_at='lower' joint='elbow'/>"
    "<sensor type='force_torque' name='AT_BASE' insert_at='base' joint='shoulder'/>";

TEST_CASE("the joints of an arm at rest carry what is behind them") {
  Simulation simulation = arm(kArm, "", kArmSensors, 15);
  for (const double shoulder_deg : {0.0, -30.0}) {
    simulation.set("ROBOT", "target_shoulder", shoulder_deg);
    run(simulation, 60);
    const double turn = glm::radians(shoulder_deg);
    // From the frame of the arm, which is turned about y, to the world and back.
    const auto in_arm = [&](const glm::dvec3& v) {
      return glm::dvec3(std::cos(turn) * v.x - std::sin(turn) * v.z, v.y, std::sin(turn) * v.x + std::cos(turn) * v.z);
    };
    const double g = kGravity_m_s2;
    // Weights of 2 kg at 0.25 m, 2 kg at 0.75 m and 0.5 kg at 1 m along the arm. What is left of the drives' motion
    // is what trembles.
    const Load shoulder = load_of(simulation, "SHOULDER"), elbow = load_of(simulation, "ELBOW"),
               base = load_of(simulation, "AT_BASE");
    const double weight_n = 4.5 * g, lever_nm = 2.5 * g * std::cos(turn);
    CHECK(glm::length(shoulder.force_n - in_arm({0, 0, -weight_n})) < kTremble * weight_n);
    CHECK(glm::length(shoulder.torque_nm - glm::dvec3(0, lever_nm, 0)) < kTremble * lever_nm);
    CHECK(glm::length(elbow.force_n - in_arm({0, 0, -2.5 * g})) < kTremble * 2.5 * g);
    CHECK(glm::length(elbow.torque_nm - glm::dvec3(0, 0.75 * g * std::cos(turn), 0)) < kTremble * g);
    CHECK(glm::length(base.force_n - glm::dvec3(0, 0, -weight_n)) < kTremble * weight_n);
    CHECK(glm::length(base.torque_nm - glm::dvec3(0, lever_nm, 0)) < kTremble * lever_nm);
  }
}

// A cube of 2 kg that a spring of 10 kN/m holds at the world, and another one that stands on a plane.
const char* const kSensedSdf = R"(<sdf version='1.9'><world name='w'>
  <model name='floor'><static>1</static><link name='l'>
    <visual name='v'><geometry><box><size>0.1 0.1 0.1</size></box></geometry></visual>
    <collision name='c'><geometry><plane/></geometry></collision></link></model>
  <model name='hung'><pose>3 0 2 0 0 0</pose><link name='l'><inertial><mass>2</mass></inertial></link>
    <joint name='j' type='prismatic'><parent>world</parent><child>l</child>
      <axis><xyz>0 0 1</xyz><dynamics><spring_stiffness>10000</spring_stiffness><damping>200</damping></dynamics></axis>
      <sensor name='ft' type='force_torque'/></joint></model>
  <model name='box'><pose>0 0 0.5 0 0 0</pose><link name='l'>
    <inertial><mass>2</mass><inertia><ixx>0.33</ixx><iyy>0.33</iyy><izz>0.33</izz></inertia></inertial>
    <collision name='c'><geometry><box><size>1 1 1</size></box></geometry></collision>
    <sensor name='touch' type='contact'><contact><collision>c</collision></contact></sensor></link></model>
</world></sdf>)";

TEST_CASE("sensors of forces that an SDF world brings measure with physics, and nothing without") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "w.sdf") << kSensedSdf;
  const std::string part = "<part name='W' insert_at='ROOT' file='w.sdf'/>\n";
  Simulation still = Simulation::from_string(part, {}, folder.path());
  still.step();
  CHECK(still.value("hung/j/ft", "force_z_n") == 0);
  CHECK(still.reading("box/l/touch").rows() == 0);
  Simulation moving = Simulation::from_string(part + kPhysics + "<element type='models' name='BODIES' insert_at='W'/>",
                                              {}, folder.path());
  run(moving, 60);
  const double weight_n = 2 * kGravity_m_s2;
  CHECK(std::abs(moving.value("hung/j/ft", "force_z_n") + weight_n) < kTremble * weight_n);
  CHECK(std::abs(sum_of(moving.reading("box/l/touch")).force_n - weight_n) < kTremble * weight_n);
}

TEST_CASE("a fixed joint that is kept carries what is behind it, and changes no motion") {
  const std::string at_wrist =
      "<sensor type='force_torque' name='WRIST' insert_at='grip' fixed_joint='wrist'/>"
      "<sensor type='force_torque' name='AT_ELBOW' insert_at='lower' fixed_joint='wrist'/>";
  Simulation kept = arm(kArm, "kept_joints='wrist'", at_wrist, 15), merged = arm(kArm, "", "", 15);
  run(kept, 60);
  run(merged, 60);
  // The gripper of 0.5 kg hangs 0.5 m in front of the elbow.
  const double weight_n = 0.5 * kGravity_m_s2, lever_nm = 0.5 * weight_n;
  const Load wrist = load_of(kept, "WRIST"), elbow = load_of(kept, "AT_ELBOW");
  CHECK(glm::length(wrist.force_n - glm::dvec3(0, 0, -weight_n)) < kTremble * weight_n);
  CHECK(glm::length(wrist.torque_nm) < kTremble * lever_nm);
  CHECK(glm::length(elbow.torque_nm - glm::dvec3(0, lever_nm, 0)) < kTremble * lever_nm);
  // The same motion from other sums: the rounding of some thousand steps, in degrees.
  CHECK(std::abs(kept.get("elbow", "value") - merged.get("elbow", "value")) < 1e-6);
}

TEST_CASE("a fixed joint that is not kept or not there is an error") {
  const auto wrong = [](const std::string& attributes, const std::string& sensor) {
    return error_of([&] { run(*std::make_unique<Simulation>(arm(kArm, attributes, sensor, 15)), 1); });
  };
  CHECK(contains(wrong("kept_joints='wrst'", ""), "there is no fixed joint \"wrst\", did you mean \"wrist\""));
  CHECK(contains(wrong("kept_joints='elbow'", ""), "there is no fixed joint \"elbow\""));
  CHECK(contains(wrong("", "<sensor type='force_torque' name='F' insert_at='grip' fixed_joint='wrist'/>"),
                 "no robot of physics moves the joint \"wrist\""));
  CHECK(contains(wrong("kept_joints='wrist'",
                       "<sensor type='force_torque' name='F' insert_at='grip' joint='elbow' fixed_joint='wrist'/>"),
                 "attribute \"fixed_joint\" is not allowed beside \"joint\""));
}

TEST_CASE("a swinging pendulum pulls its joint with weight and centrifugal force") {
  Simulation simulation =
      arm(kPendulum, "control='none'", "<sensor type='force_torque' name='F' insert_at='bar' joint='swing'/>", 1000);
  // From rest at the horizontal to the lowest place: w^2 = 2 m g c / I.
  const double about_joint = 1.0 / 12 + 0.25, speed = std::sqrt(2 * kGravity_m_s2 * 0.5 / about_joint);
  const double expected_n = kGravity_m_s2 + speed * speed * 0.5;
  double before_deg = 0;
  for (int i = 0; i < 1000; ++i) {
    simulation.step();
    const double now_deg = simulation.get("swing", "value");
    if (before_deg < 90 && now_deg >= 90) {
      const Load load = load_of(simulation, "F");
      // The bar's x points down. In a step it turns by w h: forces along and across mix by this, and the speed is
      // that of half a step away.
      const double mixed = 2 * speed * kStep_s;
      CHECK(std::abs(load.force_n.x - expected_n) < mixed * expected_n);
      CHECK(std::abs(load.force_n.z) < mixed * expected_n);
      CHECK(std::abs(load.torque_nm.y) < mixed * expected_n * 0.5);
      return;
    }
    before_deg = now_deg;
  }
  FAIL("the pendulum has not come down");
}

TEST_CASE("sensors of forces change nothing of what moves, and do nothing while they are off") {
  const auto moved = [](const std::string& sensors, bool on) {
    Simulation simulation = arm(kArm, "control='none'", sensors, 100);
    if (!on) simulation.enable("SHOULDER", false);
    std::vector<double> values;
    for (int i = 0; i < 20; ++i) {
      simulation.step();
      for (const char* const joint : {"shoulder", "elbow"}) values.push_back(simulation.get(joint, "value"));
    }
    CHECK((on || simulation.reading("SHOULDER").rows() == 0));
    return values;
  };
  const std::vector<double> without = moved("", true);
  CHECK(moved(kArmSensors, true) == without);
  CHECK(moved("<sensor type='force_torque' name='SHOULDER' insert_at='upper' joint='shoulder'/>"
              "<sensor type='contact' name='C' insert_at='upper'/>",
              false) == without);
}

TEST_CASE("forces have the noise of their attributes") {
  constexpr int kSamples = 400;
  Simulation simulation = arm(kArm, "",
                              "<sensor type='force_torque' name='EXACT' insert_at='base' joint='elbow'/>"
                              "<sensor type='force_torque' name='NOISY' insert_at='base' joint='elbow' "
                              "force_stddev='0.5' torque_bias_mean='2'/>",
                              1000);
  double squares = 0;
  for (int i = 0; i < kSamples; ++i) {
    simulation.step();
    const double error_n = simulation.value("NOISY", "force_z_n") - simulation.value("EXACT", "force_z_n");
    squares += error_n * error_n / 0.25;
    CHECK(std::abs(simulation.value("NOISY", "torque_x_n_m") - simulation.value("EXACT", "torque_x_n_m") - 2) < 1e-12);
  }
  // Chi-square with 400 degrees of freedom: 4 standard deviations of sqrt(2 n).
  CHECK(std::abs(squares - kSamples) < 4 * std::sqrt(2.0 * kSamples));
}

TEST_CASE("a joint without physics is an error") {
  CHECK(contains(error_of([] {
                   Simulation simulation = Simulation::from_string(
                       "<part name='A' insert_at='ROOT'/><element type='joint' name='J' insert_at='A'/>"
                       "<sensor type='force_torque' name='F' insert_at='A' joint='J'/>");
                   simulation.step();
                 }),
                 "sensor \"F\": no robot of physics moves the joint \"J\", expected"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
