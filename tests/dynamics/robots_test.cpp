// Jointed bodies and vehicles against closed formulas.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kPi = std::numbers::pi;

MovingScene robot_scene(const std::string& urdf, const std::string& attributes, const std::string& before = kPhysics) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "robot.urdf") << urdf;
  return MovingScene(before +
                         "<part name='R' insert_at='ROOT' file='robot.urdf' pose_offset='0 0 2 0 0 0'/>\n"
                         "<element type='robot' name='ROBOT' insert_at='R' " +
                         attributes + "/>",
                     folder.path());
}

TEST_CASE("a pendulum swings with its period, and keeps its energy") {
  MovingScene scene = robot_scene(kPendulum, "control='none'");
  // Positive turns about y bring +x down. It starts 20 degrees from hanging.
  constexpr double kStart_deg = 20;
  scene.set("swing", "value", 90 - kStart_deg);
  // T = 4 sqrt(I / (m g c)) K(sin(a / 2)); K by the arithmetic-geometric mean.
  const double about_joint = 1.0 / 12 + 0.25, k = std::sin(glm::radians(kStart_deg) / 2);
  double a = 1, g = std::sqrt(1 - k * k);
  for (int i = 0; i < 6; ++i) std::tie(a, g) = std::pair((a + g) / 2, std::sqrt(a * g));
  const double period_s = 2 * kPi / a * std::sqrt(about_joint / (kGravity_m_s2 * 0.5));
  const auto angle = [&] { return glm::radians(scene.get("swing", "value") - 90); };
  double first = 0, last = 0, before = angle(), highest = 0;
  int crossings = 0;
  const double end_s = 10 * period_s;
  for (double t = kStep_s; t < end_s; t += kStep_s) {
    scene.go_to(t);
    const double now = angle();
    if (before < 0 && now >= 0) {
      last = t - kStep_s * now / (now - before);
      if (crossings++ == 0) first = last;
    }
    if (t > end_s - period_s) highest = std::max(highest, now);
    before = now;
  }
  REQUIRE(crossings > 8);
  // Steps of h bring an error of (w h)^2 / 24 into the period, and the crossings are found to some ns: 1e-5 is both.
  CHECK(std::abs((last - first) / (crossings - 1) / period_s - 1) < 1e-5);
  // Semi-implicit steps keep the energy on average; the amplitude moves by w h / 2 of itself within a swing.
  const double w = 2 * kPi / period_s;
  CHECK(std::abs(highest / glm::radians(kStart_deg) - 1) < w * kStep_s / 2 + 1e-4);
}

TEST_CASE("an arm holds its pose under gravity, and goes to its targets at the joints' speed") {
  MovingScene scene = robot_scene(kArm, "");
  scene.set("ROBOT", "target_shoulder", -30);
  scene.set("ROBOT", "target_elbow", 60);
  scene.go_to(0.2);
  // 2 rad/s is the limit: after 0.2 s the elbow has turned by no more than 23 degrees.
  CHECK(scene.get("elbow", "value") < 23);
  CHECK(scene.get("elbow", "value") > 20);
  scene.go_to(3);
  // The drives are constraints: what gravity does in one step, g h over the length of the arm, is what is left.
  const double left_deg = glm::degrees(kGravity_m_s2 * kStep_s / 20);
  CHECK(std::abs(scene.get("shoulder", "value") + 30) < left_deg);
  CHECK(std::abs(scene.get("elbow", "value") - 60) < left_deg);
  CHECK(scene.position("grip").z > 2.0 - 0.001);
  // -30 degrees lift the upper link, the elbow brings the lower one down by as much: the gripper is at the height 0.
  CHECK(std::abs(scene.position("grip").z - 2) < 2e-3);
  CHECK(std::abs(scene.position("grip").x - 2 * 0.5 * std::cos(glm::radians(30.0))) < 2e-3);
}

TEST_CASE("an effort accelerates a joint, and a limit stops it") {
  MovingScene scene = robot_scene(kArm, "control='effort' position_joints='elbow'", physics("gravity='0 0 0'"));
  scene.set("ROBOT", "target_shoulder", 10);
  scene.go_to(0.05);
  const double turned = scene.get("shoulder", "value");
  CHECK(turned > 0);
  scene.go_to(3);
  CHECK(std::abs(scene.get("shoulder", "value") - glm::degrees(1.5)) < 0.5);  // its limit
}

TEST_CASE("a free base falls with its joints, and a restart brings all back") {
  const std::string heavy =
      kArm.substr(0, kArm.find("<visual>")) + inertial(5, "0 0 0", 0.1) + kArm.substr(kArm.find("<visual>"));
  MovingScene scene = robot_scene(heavy, "base='free'");
  const std::vector<double> start = scene.values();
  scene.go_to(0.4);
  // The centre of mass falls freely; held joints keep the shape, so the base does the same.
  CHECK(std::abs(scene.position("R").z - (2 - kGravity_m_s2 * 0.4 * (0.4 + kStep_s) / 2)) < 1e-6);
  scene.set("PHYSICS", "restarts", 1);
  scene.go_to(0.5);
  std::vector<double> again = scene.values();
  again[1] = 0;
  CHECK(again == start);
}

TEST_CASE("a collision mesh without materials is the convex hull of its points") {
  const TemporaryFolder folder;
  // A pyramid of 1 m in height that stands on its square side of 2 m.
  std::ofstream(folder.path() / "pyramid.obj") << "v 1 1 0\nv -1 1 0\nv -1 -1 0\nv 1 -1 0\nv 0 0 1\n"
                                                  "f 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
  std::ofstream(folder.path() / "robot.urdf")
      << "<robot name='p'><link name='base'>" + inertial(2, "0 0 0.25", 0.5) +
             "<collision><geometry><mesh filename='pyramid.obj' scale='0.5 0.5 0.5'/></geometry></collision></link>"
             "</robot>";
  MovingScene scene(kPhysics + ground() +
                        "<part name='R' insert_at='ROOT' file='robot.urdf' pose_offset='0 0 0.1 0 0 0'/>"
                        "<element type='robot' name='ROBOT' insert_at='R' base='free'/>",
                    folder.path());
  scene.run(0, 1, 0.1);
  CHECK(std::abs(scene.position("R").z) < 1e-3);  // it has come down 0.1 m, and rests as boxes do
}

// A body of 10 kg on four light legs with ball feet, driven to straight legs: the masses and the frame of a quadruped.
std::string quadruped() {
  std::string urdf =
      "<robot name='q'><link name='body'>" + visual("0.6 0.3 0.1", "0 0 0") + inertial(10, "0 0 0", 0.3) + "</link>";
  for (const auto& [name, place] :
       {std::pair("a", "0.3 0.2 0"), {"b", "0.3 -0.2 0"}, {"c", "-0.3 0.2 0"}, {"d", "-0.3 -0.2 0"}}) {
    const std::string leg(name);
    urdf += "<link name='thigh_" + leg + "'>" + inertial(0.4, "0 0 -0.1", 0.003) + "</link><link name='shin_" + leg +
            "'>" + inertial(0.1, "0 0 -0.1", 0.001) +
            "<collision><origin xyz='0 0 -0.2'/><geometry><sphere radius='0.03'/></geometry></collision></link>"
            "<joint name='hip_" +
            leg + "' type='revolute'><parent link='body'/><child link='thigh_" + leg + "'/><origin xyz='" + place +
            "'/><axis xyz='0 1 0'/>"
            "<limit lower='-1' upper='1' effort='50' velocity='10'/></joint>"
            "<joint name='knee_" +
            leg + "' type='revolute'><parent link='thigh_" + leg + "'/><child link='shin_" + leg +
            "'/><origin xyz='0 0 -0.2'/><axis xyz='0 1 0'/>"
            "<limit lower='-1' upper='1' effort='50' velocity='10'/></joint>";
  }
  return urdf + "</robot>";
}

TEST_CASE("a robot stands on small feet on a slope below the angle of friction") {
  // Gravity leans by 20 degrees, of which the tangent is 0.36; friction is 0.7.
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "robot.urdf") << quadruped();
  const double lean = glm::radians(20.0);
  char gravity[128];
  std::snprintf(gravity, sizeof(gravity), "gravity='%.17g 0 %.17g' iterations='1000'", kGravity_m_s2 * std::sin(lean),
                -kGravity_m_s2 * std::cos(lean));
  MovingScene scene(physics(gravity) + ground("friction='1'") +
                        "<part name='R' insert_at='ROOT' file='robot.urdf' pose_offset='0 0 0.43 0 0 0'/>"
                        "<element type='robot' name='ROBOT' insert_at='R' base='free'/>",
                    folder.path());
  scene.go_to(1);
  const glm::dvec3 start = scene.position("R");
  scene.go_to(3);
  // What gravity brings in a step, g h, is taken back by the solver, except what 1000 passes leave of it.
  constexpr double kLeft = 0.02;
  CHECK(glm::length(scene.position("R") - start) < kLeft * kGravity_m_s2 * kStep_s * 2);
}

TEST_CASE("mistakes in robots name their place") {
  const auto wrong = [](const std::string& urdf, const std::string& attributes) {
    return error_of([&] { robot_scene(urdf, attributes); });
  };
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  CHECK(contains(wrong(kArm, "velocity_joints='elbow' free_joints='elbow'"),
                 "joint \"elbow\" is also one of \"velocity_joints\""));
  CHECK(contains(wrong(kArm, "velocity_joints='elbo'"), "there is no joint \"elbo\", did you mean \"elbow\""));
  CHECK(contains(wrong(kArm, "base='free'"), "link \"base\" moves and has no mass"));
  CHECK(contains(wrong(with(kArm, "mass value='2'", "mass value='-2'"), ""), "mass has value -2, expected at least 0"));
  CHECK(contains(wrong(with(kArm, "mass value='2'", "mass value='0'"), ""), "link \"upper\" moves and has no mass"));
  CHECK(contains(wrong(with(kArm, "ixx='0.05'", "ixx='much'"), ""),
                 "inertia has ixx \"much\", expected 1 finite number"));
  CHECK(contains(wrong(kArm, "/><element type='robot' name='R2' insert_at='R'"), "moved by another robot"));
  CHECK(contains(error_of([] {
                   MovingScene(kPhysics +
                               "<part name='A' insert_at='ROOT' shape='box' size='1 1 1'/>"
                               "<element type='robot' name='B' insert_at='A'/>");
                 }),
                 "expected the name of a part from a URDF, SDF or MJCF file"));
}

TEST_CASE("a stiff joint that explodes is reported with its robot and the time") {
  std::string urdf = kArm;
  for (const auto& [from, to] : {std::pair("velocity='2'", ""), {"'revolute'", "'continuous'"}}) {
    for (std::size_t at = urdf.find(from); at != std::string::npos; at = urdf.find(from))
      urdf.replace(at, std::string(from).size(), to);
  }
  MovingScene scene = robot_scene(urdf, "gain='1e7' max_effort='1e12'");
  scene.set("ROBOT", "target_elbow", 100);
  try {
    scene.go_to(5);
    FAIL("expected an Error");
  } catch (const Error& error) {
    CHECK(contains(error.what(), "element \"ROBOT\" has exploded at 0.00"));
  }
  for (const double value : scene.values()) CHECK(std::isfinite(value));
}

std::string vehicle(const std::string& attributes, const std::string& center = "-0.05") {
  return kPhysics + ground("friction='1'") +
         "<part name='CAR' insert_at='ROOT' shape='box' size='0.6 0.3 0.2' pose_offset='0 0 0 0 0 0'/>\n"
         "<element type='vehicle' name='DRIVE' insert_at='CAR' mass='10' clearance='0.05' center='" +
         center + " 0 0.1' " + attributes + "/>\n";
}

// Fits no circle: compares with the one that the wheels say.
TEST_CASE("a differential drive follows the circle of its wheels") {
  MovingScene scene(vehicle("left='90' right='180'"));
  scene.go_to(1);  // it has its speed
  const glm::dmat4 start = scene.pose("CAR");
  const double left = glm::radians(90.0) * 0.1, right = glm::radians(180.0) * 0.1;  // m/s
  const double speed = (left + right) / 2, turn = (right - left) / 0.4, radius = speed / turn;
  for (const double t : {1.0, 4.0, 8.0}) {
    scene.go_to(1 + t);
    const double angle = turn * t;
    const glm::dvec3 expected(start * glm::dvec4(radius * std::sin(angle), radius * (1 - std::cos(angle)), 0, 1));
    // Wheels slip by what one step of friction leaves: some 1e-3 of the way.
    CHECK(glm::length(glm::dvec2(scene.position("CAR") - expected)) < 2e-3 * speed * t + 1e-4);
  }
  CHECK(std::abs(scene.position("CAR").z) < 1e-3);
}

TEST_CASE("an ackermann drive follows the circle of its steering") {
  MovingScene scene(vehicle("drive='ackermann' wheelbase='0.5' axle='-0.25' steer='20' speed='200'", "0"));
  scene.go_to(2);
  const glm::dmat4 start = scene.pose("CAR");
  const double speed = glm::radians(200.0) * 0.1, radius = 0.5 / std::tan(glm::radians(20.0)), turn = speed / radius;
  for (const double t : {1.0, 5.0}) {
    scene.go_to(2 + t);
    const double angle = turn * t;
    // The middle of the rear axle, 0.25 behind the part's origin.
    const glm::dvec3 expected(start *
                              glm::dvec4(-0.25 + radius * std::sin(angle), radius * (1 - std::cos(angle)), 0, 1));
    const glm::dvec3 rear(scene.pose("CAR") * glm::dvec4(-0.25, 0, 0, 1));
    CHECK(glm::length(glm::dvec2(rear - expected)) < 5e-3 * speed * t + 1e-4);
  }
}

TEST_CASE("a parameter of the other drive is refused") {
  CHECK(contains(error_of([] { MovingScene scene(vehicle("steer='1'")); }),
                 "attribute \"steer\" is allowed only for an ackermann drive"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
