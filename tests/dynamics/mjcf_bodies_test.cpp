// MJCF models in physics: masses, joints, actuators, equalities and contacts, against closed formulas and a slow
// integration in small steps.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "tests/support/moving_scene.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kMjcfGravity = 9.81;

MovingScene mjcf_scene(const std::string& content, const std::string& element = "type='models'") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "m.xml") << "<mujoco model='m'><option timestep='0.001'/>\n" + content + "</mujoco>";
  return MovingScene("<part name='M' insert_at='ROOT' file='m.xml'/>\n" + physics("world='M'") + "<element " + element +
                         " name='BODIES' insert_at='M'/>",
                     folder.path());
}

bool mjcf_warns(MovingScene& scene, const char* what) {
  const std::vector<std::string> warnings = (*scene).scene.warnings();
  return std::ranges::any_of(warnings, [&](const std::string& each) { return contains(each, what); });
}

// A capsule of 1 m along x with the radius 0.05 m, of water, that turns about y at its end: it falls with positive
// angles.
constexpr double kRodRadius_m = 0.05, kRodLength_m = 1, kWater = 1000;
std::string rod(const std::string& joint, const std::string& more = "") {
  return "<worldbody><body name='rod' pos='0 0 2'><joint name='j' axis='0 1 0' " + joint +
         "/><geom type='capsule' fromto='0 0 0 1 0 0' size='0.05' contype='0' conaffinity='0'/></body></worldbody>" +
         more;
}
// A cylinder and two half balls, whose centres of mass lie 3/8 of the radius outside.
struct RodMass {
  double mass_kg = 0, inertia_kg_m2 = 0;  // about the joint
};
RodMass rod_mass() {
  const double r = kRodRadius_m, l = kRodLength_m, pi = std::numbers::pi;
  const double cylinder = kWater * pi * r * r * l, half_ball = kWater * 2 * pi / 3 * r * r * r;
  // About the middle of the rod; of a half ball, 2/5 m r^2 about the ball's centre, moved to its own and outwards.
  const double own = 2.0 / 5 * half_ball * r * r - half_ball * std::pow(3 * r / 8, 2);
  const double middle = cylinder * (l * l / 12 + r * r / 4) + 2 * (own + half_ball * std::pow(l / 2 + 3 * r / 8, 2));
  const double mass = cylinder + 2 * half_ball;
  return {mass, middle + mass * std::pow(l / 2, 2)};
}

// The angle after 1 s of inertia * a = torque(angle, speed), from rest, by Runge and Kutta's method of the fourth order
// in steps of 10 us, and the largest speed and acceleration.
struct Swing {
  double angle = 0, fastest = 0, quickest = 0;
};
Swing swing_of(double inertia, const std::function<double(double, double)>& torque) {
  constexpr double kTiny_s = 1e-5;
  Swing swing;
  double q = 0, v = 0;
  const auto a = [&](double at, double speed) { return torque(at, speed) / inertia; };
  for (int i = 0; i < 100000; ++i) {
    const double h = kTiny_s, k1 = a(q, v), k2 = a(q + h / 2 * v, v + h / 2 * k1),
                 k3 = a(q + h / 2 * (v + h / 2 * k1), v + h / 2 * k2), k4 = a(q + h * (v + h / 2 * k2), v + h * k3);
    swing.fastest = std::max(swing.fastest, std::abs(v));
    swing.quickest = std::max(swing.quickest, std::abs(k1));
    q += h * v + h * h / 6 * (k1 + k2 + k3);
    v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  swing.angle = q;
  return swing;
}

// Semi-implicit steps are of the first order: each of 1000 adds h^2 a / 2, which is h a / 2 after 1 s, and damping
// makes it less.
double step_error_deg(const Swing& swing) { return glm::degrees(kStep_s * swing.quickest / 2); }

TEST_CASE("a rod of an MJCF model swings as its masses, damping, spring and rotor say") {
  const RodMass mass = rod_mass();
  const double weight = mass.mass_kg * kMjcfGravity * kRodLength_m / 2;
  struct Row {
    const char* joint;
    double damping, stiffness, rest_deg, rotor;
  };
  for (const Row& row :
       {Row{"", 0, 0, 0, 0}, Row{"damping='2'", 2, 0, 0, 0},
        Row{"damping='5' stiffness='200' springref='-10'", 5, 200, -10, 0}, Row{"armature='0.5'", 0, 0, 0, 0.5}}) {
    CAPTURE(row.joint);
    MovingScene scene = mjcf_scene(rod(row.joint));
    scene.go_to(1);
    const Swing swing = swing_of(mass.inertia_kg_m2 + row.rotor, [&](double q, double v) {
      return weight * std::cos(q) - row.damping * v - row.stiffness * (q - glm::radians(row.rest_deg));
    });
    CHECK(std::abs(scene.get("j", "value") - glm::degrees(swing.angle)) < step_error_deg(swing));
  }
}

TEST_CASE("the rotor of a joint resists the motion of that joint alone") {
  // A body with the inertia or mass 3 carries one with 2, whose joint has a rotor of 5 and a motor of 6. With both
  // accelerations p and q: 5 p + 2 q = 0, 2 p + (2 + 5) q = 6. A rotor that turned with its body would give q = 2.06.
  constexpr double kFirst = 3, kSecond = 2, kRotor = 5, kEffort = 6, kTime_s = 0.5;
  const double q = kEffort / (kSecond + kRotor - kSecond * kSecond / (kFirst + kSecond)),
               p = -kSecond * q / (kFirst + kSecond), steps = kTime_s * (kTime_s + 1e-3) / 2;
  for (const bool turns : {true, false}) {
    CAPTURE(turns);
    const std::string kind = turns ? "axis='0 0 1'" : "type='slide' axis='1 0 0'";
    MovingScene scene = mjcf_scene(
        "<option gravity='0 0 0'/><worldbody><body name='a'><joint name='p' " + kind +
        "/><inertial pos='0 0 0' mass='3' diaginertia='3 3 3'/><body name='b'><joint name='q' " + kind +
        " armature='5'/><inertial pos='0 0 0' mass='2' diaginertia='2 2 2'/></body></body></worldbody><actuator><motor "
        "joint='q'/></actuator>");
    scene.set("BODIES", "target_q", kEffort);
    scene.go_to(kTime_s);
    const double to_si = turns ? glm::radians(1.0) : 1;
    // The passes end at changes of 1e-8 m/s, in each step.
    constexpr double kPasses = 1e-8 * kTime_s;
    CHECK(std::abs(scene.get("q", "value") * to_si - q * steps) < kPasses);
    CHECK(std::abs(scene.get("p", "value") * to_si - p * steps) < kPasses);
  }
}

TEST_CASE("a spring of an MJCF model comes to rest where it carries the weight") {
  MovingScene scene = mjcf_scene(
      "<worldbody><body name='b' pos='0 0 1'><joint name='s' type='slide' axis='0 0 1' stiffness='400' "
      "springref='0.1' damping='80'/><geom type='box' size='0.1 0.1 0.1' mass='4'/></body></worldbody>");
  scene.go_to(3);
  // 400 N/m * (z - 0.1 m) = -4 kg g; the critical damping of 80 N s/m leaves e^-30 of the way.
  CHECK(std::abs(scene.get("s", "value") - (0.1 - 4 * kMjcfGravity / 400)) < 1e-9);
}

TEST_CASE("a light joint with much damping creeps, and does not explode") {
  // 10 g at 2 cm, with 0.5 N m s/rad: in a step of 1 ms the damping takes 100 times the speed. From the start on, the
  // speed is that at which it carries the weight.
  MovingScene scene = mjcf_scene(
      "<worldbody><body name='f' pos='0 0 1'><joint name='j' axis='0 1 0' damping='0.5'/><inertial pos='0.02 0 0' "
      "mass='0.01' diaginertia='1e-6 1e-6 1e-6'/><geom type='sphere' size='0.01' contype='0' conaffinity='0'/></body>"
      "</worldbody>");
  scene.go_to(10);
  const double turned = glm::radians(scene.get("j", "value"));
  // damping * q' = m g d cos(q): sin(q) = tanh(m g d t / damping).
  CHECK(std::sin(turned) == doctest::Approx(std::tanh(0.01 * kMjcfGravity * 0.02 * 10 / 0.5)).epsilon(1e-3));
}

TEST_CASE("limits of an MJCF model hold, and friction holds what its effort can") {
  MovingScene stopped = mjcf_scene(rod("range='-180 30'"));
  stopped.run(0, 2, 0.01);
  CHECK(std::abs(stopped.get("j", "value") - 30) < 0.1);
  const double weight = rod_mass().mass_kg * kMjcfGravity * kRodLength_m / 2;
  MovingScene held = mjcf_scene(rod("frictionloss='" + format_number(weight * 1.01) + "'"));
  held.go_to(1);
  CHECK(std::abs(held.get("j", "value")) < 1e-6);
  MovingScene slipping = mjcf_scene(rod("frictionloss='5'"));
  slipping.go_to(1);
  const Swing swing =
      swing_of(rod_mass().inertia_kg_m2, [&](double q, double v) { return weight * std::cos(q) - (v >= 0 ? 5 : -5); });
  CHECK(std::abs(slipping.get("j", "value") - glm::degrees(swing.angle)) < step_error_deg(swing));
}

TEST_CASE("actuators of an MJCF model drive joints") {
  const RodMass mass = rod_mass();
  const double weight = mass.mass_kg * kMjcfGravity * kRodLength_m / 2;
  const auto actuator = [](const std::string& text) { return "<actuator>" + text + "</actuator>"; };
  MovingScene motor = mjcf_scene(rod("", actuator("<motor joint='j' gear='10' ctrlrange='-2 2'/>")));
  motor.set("BODIES", "target_j", -20);  // N m: the gear is part of it
  motor.go_to(1);
  const Swing pushed = swing_of(mass.inertia_kg_m2, [&](double q, double) { return weight * std::cos(q) - 20; });
  CHECK(std::abs(motor.get("j", "value") - glm::degrees(pushed.angle)) < step_error_deg(pushed));
  CHECK(contains(error_of([&] { motor.set("BODIES", "target_j", -21); }), "target_j"));

  const char* const positions[] = {"<position joint='j' kp='300' kv='20' ctrlrange='-3 3'/>",
                                   "<general joint='j' biastype='affine' gainprm='300' biasprm='0 -300 -20'/>"};
  for (const char* const each : positions) {
    MovingScene position = mjcf_scene(rod("", actuator(each)));
    position.set("BODIES", "target_j", 40);
    position.go_to(1);
    const Swing held = swing_of(mass.inertia_kg_m2, [&](double q, double v) {
      return weight * std::cos(q) + 300 * (glm::radians(40.0) - q) - 20 * v;
    });
    CHECK(std::abs(position.get("j", "value") - glm::degrees(held.angle)) < step_error_deg(held));
  }
  MovingScene velocity = mjcf_scene(rod("", actuator("<velocity joint='j' kv='100'/>")));
  velocity.set("BODIES", "target_j", 57.29577951308232);  // 1 rad/s
  velocity.go_to(1);
  const Swing turned =
      swing_of(mass.inertia_kg_m2, [&](double q, double v) { return weight * std::cos(q) + 100 * (1 - v); });
  CHECK(std::abs(velocity.get("j", "value") - glm::degrees(turned.angle)) < step_error_deg(turned));
}

TEST_CASE("an actuator of an MJCF model starts where it drives the joint with the control value 0") {
  struct Row {
    const char *joint, *actuator;
    double start;  // of the parameter, in deg or N m
  };
  for (const Row& row :
       {// 0 in the file is 40 degrees below what the file shows as 40.
        Row{"ref='40'", "<position joint='j' kp='300' kv='20'/>", -40},
        Row{"ref='40' range='-90 90'", "<position joint='j' kp='300' ctrlrange='0.5 1'/>",
            glm::degrees(0.5) - 40},  // the nearest control value
        Row{"", "<position joint='j' kp='300' gear='2'/>", 0},
        // 30 N m - 300 N m/rad q: at rest at 0.1 rad.
        Row{"", "<general joint='j' biastype='affine' gainprm='300' biasprm='30 -300 -20'/>", glm::degrees(0.1)},
        Row{"", "<general joint='j' biastype='affine' gainprm='2' biasprm='7 0 0'/>", 7},
        Row{"", "<velocity joint='j' kv='3'/>", 0}}) {
    CAPTURE(row.joint);
    CAPTURE(row.actuator);
    MovingScene scene = mjcf_scene(rod(row.joint, "<actuator>" + std::string(row.actuator) + "</actuator>"));
    CHECK(scene.get("BODIES", "target_j") == doctest::Approx(row.start).epsilon(1e-12));
  }
}

TEST_CASE("ranges of force and biases that drive away act as MuJoCo says") {
  const RodMass mass = rod_mass();
  const double weight = mass.mass_kg * kMjcfGravity * kRodLength_m / 2;
  struct Row {
    const char *joint, *actuator;
    double target;
    std::function<double(double q, double v)> effort;
  };
  const auto between = [](double low, double high) {
    return [low, high](double q, double v) { return std::clamp(3000 * (0.7 - q) - 20 * v, low, high); };
  };
  const double target = glm::degrees(0.7);
  const std::vector<Row> rows = {
      // The weight alone would turn the rod beyond 0.7 rad; the drive pulls back with 0 or 10 N m at most.
      {"", "<position joint='j' kp='3000' kv='20' forcerange='0 30'/>", target, between(0, 30)},
      {"", "<position joint='j' kp='3000' kv='20' forcerange='-10 0'/>", target, between(-10, 0)},
      {"", "<position joint='j' kp='750' kv='5' gear='-2' forcerange='0 5'/>", target, between(-10, 0)},
      {"actuatorfrcrange='-5 20'", "<position joint='j' kp='3000' kv='20' forcerange='-10 30'/>", target,
       between(-5, 20)},
      {"actuatorfrcrange='-5 20' actuatorfrclimited='false'",
       "<position joint='j' kp='3000' kv='20' forcerange='-10 30'/>", target, between(-10, 30)},
      // Effort 10 N m at the start, and 5 N m/rad or 2 N m s/rad more with the way or the speed.
      {"", "<general joint='j' biastype='affine' biasprm='10 5 0'/>", glm::degrees(-2.0),
       [](double q, double) { return 10 + 5 * q; }},
      {"", "<general joint='j' biastype='affine' biasprm='10 0 2'/>", glm::degrees(-5.0),
       [](double, double v) { return 10 + 2 * v; }}};
  for (const Row& row : rows) {
    CAPTURE(row.actuator);
    MovingScene scene = mjcf_scene(rod(row.joint, "<actuator>" + std::string(row.actuator) + "</actuator>"));
    scene.set("BODIES", "target_j", row.target);
    scene.go_to(1);
    const Swing swing =
        swing_of(mass.inertia_kg_m2, [&](double q, double v) { return weight * std::cos(q) + row.effort(q, v); });
    CHECK(std::abs(scene.get("j", "value") - glm::degrees(swing.angle)) < step_error_deg(swing));
  }
}

TEST_CASE("an equality of two joints makes both feel the force") {
  // The same rod twice, of which the second turns by -2 angles of the first. The energy of both is that of one joint
  // with the inertia I + 4 I, and the torque of the weights is that of the first less twice that of the second.
  MovingScene scene = mjcf_scene(
      "<worldbody><body name='frame'><geom type='sphere' size='0.1'/>"
      "<body name='a' pos='0 0 2'><joint name='ja' axis='0 1 0'/>"
      "<geom type='capsule' fromto='0 0 0 1 0 0' size='0.05' contype='0' conaffinity='0'/></body>"
      "<body name='b' pos='0 3 2'><joint name='jb' axis='0 1 0'/>"
      "<geom type='capsule' fromto='0 0 0 1 0 0' size='0.05' contype='0' conaffinity='0'/></body></body></worldbody>"
      "<equality><joint joint1='jb' joint2='ja' polycoef='0 -2 0 0 0'/></equality>");
  scene.go_to(1);
  const RodMass mass = rod_mass();
  const double weight = mass.mass_kg * kMjcfGravity * kRodLength_m / 2;
  const Swing swing =
      swing_of(5 * mass.inertia_kg_m2, [&](double q, double) { return weight * (std::cos(q) - 2 * std::cos(-2 * q)); });
  CHECK(std::abs(scene.get("ja", "value") - glm::degrees(swing.angle)) < step_error_deg(swing));
}

TEST_CASE("connect and weld hold bodies that no joint holds") {
  const std::string box = "<freejoint/><geom type='box' size='0.1 0.1 0.1' mass='1'/>";
  MovingScene scene =
      mjcf_scene("<worldbody><body name='hung' pos='0 0 2'>" + box + "</body><body name='welded' pos='3 0 2'>" + box +
                 "</body><body name='carried' pos='3 "
                 "0 1'>" +
                 box + "</body><body name='loose' pos='6 0 2'>" + box +
                 "</body></worldbody><equality><connect body1='hung' anchor='0.5 0 0'/>"
                 "<weld body1='welded'/><weld body1='carried' body2='welded'/></equality>");
  scene.run(0, 1, 0.1);
  constexpr double kHeld_m = 2e-3;
  CHECK(glm::length(scene.position("welded") - glm::dvec3(3, 0, 2)) < kHeld_m);
  CHECK(glm::length(scene.position("carried") - glm::dvec3(3, 0, 1)) < kHeld_m);
  CHECK(std::abs(scene.position("loose").z - (2 - kMjcfGravity * (1 + kStep_s) / 2)) < 1e-9);
  // A pendulum about the anchor.
  const glm::dvec3 anchor(scene.pose("hung") * glm::dvec4(0.5, 0, 0, 1));
  CHECK(glm::length(anchor - glm::dvec3(0.5, 0, 2)) < kHeld_m);
  CHECK(scene.position("hung").z < 1.9);
}

TEST_CASE("links of an MJCF model collide, except for parents and what is excluded") {
  // Two fingers slide towards each other and meet in the middle, with half a width of 0.1 m each.
  const auto fingers = [](const std::string& contact) {
    return mjcf_scene(
        "<worldbody><body name='palm'><geom type='box' size='1 1 0.1'/><body name='left' pos='0 -0.5 0.5'>"
        "<joint name='l' type='slide' axis='0 1 0' damping='20'/><geom type='box' size='0.1 0.1 0.1' mass='1'/></body>"
        "<body name='right' pos='0 0.5 0.5'><joint name='r' type='slide' axis='0 -1 0' damping='20'/>"
        "<geom type='box' size='0.1 0.1 0.1' mass='1'/></body></body></worldbody><actuator><motor joint='l'/>"
        "<motor joint='r'/></actuator>" +
        contact);
  };
  MovingScene meeting = fingers("");
  MovingScene passing = fingers("<contact><exclude body1='left' body2='right'/></contact>");
  for (MovingScene* scene : {&meeting, &passing}) {
    for (const char* target : {"target_l", "target_r"}) scene->set("BODIES", target, 10);
    scene->run(0, 3, 0.1);
  }
  CHECK(std::abs(meeting.get("l", "value") - 0.4) < 1e-3);
  CHECK(std::abs(meeting.get("r", "value") - 0.4) < 1e-3);
  CHECK(passing.get("l", "value") > 1);
}

TEST_CASE("a free MJCF body falls on the floor of its world and stays there") {
  MovingScene scene = mjcf_scene(
      "<worldbody><geom type='plane' size='5 5 0.1'/><body name='box' pos='0 0 1'><freejoint name='root'/>"
      "<geom type='box' size='0.1 0.1 0.1'/><body name='lid' pos='0 0 0.2'><joint name='hinge' axis='0 1 0' "
      "range='-10 10'/><geom type='box' size='0.1 0.1 0.02'/></body></body></worldbody>");
  scene.go_to(0.3);
  CHECK(std::abs(scene.position("box").z - (1 - kMjcfGravity * 0.3 * (0.3 + kStep_s) / 2)) < 1e-9);
  scene.run(0.3, 2, 0.1);
  CHECK(std::abs(scene.position("box").z - 0.1) < 1e-3);
}

TEST_CASE("several joints of one MJCF body move one after the other") {
  // A universal joint: first about x, then about the y that the first turns. Without gravity, a push about each keeps
  // its speed: the ball's inertia is the same about all axes.
  MovingScene scene = mjcf_scene(
      "<option gravity='0 0 0'/><worldbody><body name='ball'><joint name='a' axis='1 0 0'/><joint name='b' axis='0 1 "
      "0'/><geom type='sphere' size='0.1'/></body></worldbody><actuator><motor joint='b'/></actuator>");
  scene.set("BODIES", "target_b", 0.01);
  scene.go_to(1);
  const double mass = 4 * std::numbers::pi / 3 * 1e-3 * kWater, inertia = 0.4 * mass * 0.01;
  const double turned = glm::degrees(0.01 / inertia * (1 + kStep_s) / 2);
  CHECK(scene.get("b", "value") == doctest::Approx(turned).epsilon(1e-6));
  CHECK(std::abs(scene.get("a", "value")) < 1e-9);
}

// A ball of 0.2 m about its centre has the same inertia about all axes, so that a spring turns it back about the axis
// by which it was turned away: I q'' = -k q - c q'.
TEST_CASE("a ball joint of an MJCF model turns about any axis") {
  constexpr double kStiffness = 12, kDamping = 0.8;
  MovingScene scene = mjcf_scene(
      "<option gravity='0 0 0'/><worldbody><body name='ball' pos='1 2 3' euler='30 40 50'><joint name='neck' "
      "type='ball' "
      "stiffness='12' damping='0.8'/><geom type='sphere' size='0.2'/></body></worldbody>");
  const glm::dmat3 before(scene.pose("ball"));
  scene.set("neck", "yaw", 60);
  scene.set("neck", "roll", 25);
  const glm::dquat start = glm::quat_cast(glm::dmat3(matrix_from_degrees({0, 0, 0}, 25, 0, 60)));
  const glm::dvec3 axis = glm::axis(start);
  const double mass = 4 * std::numbers::pi / 3 * 8e-3 * kWater, inertia = 0.4 * mass * 0.04,
               brake = kDamping / (2 * inertia), own = std::sqrt(kStiffness / inertia - brake * brake);
  const double error_rad = kStep_s * kStiffness * glm::angle(start) / inertia / 2;
  for (const double t : {0.25, 0.5, 1.0}) {
    scene.go_to(t);
    const double expected =
        glm::angle(start) * std::exp(-brake * t) * (std::cos(own * t) + brake / own * std::sin(own * t));
    const glm::dmat3 turned = glm::transpose(before) * glm::dmat3(scene.pose("ball"));
    const glm::dmat3 wanted(glm::mat3_cast(glm::angleAxis(expected, axis)));
    CHECK(std::abs(expected) > 3 * error_rad);
    for (int i = 0; i < 3; ++i) CHECK(glm::length(turned[i] - wanted[i]) < error_rad);
    CHECK(glm::length(scene.position("ball") - glm::dvec3(1, 2, 3)) < 1e-12);
  }
}

TEST_CASE("an MJCF robot with a fixed base is one of the element robot") {
  MovingScene scene =
      mjcf_scene(rod("", "<actuator><position joint='j' kp='3000' kv='200'/></actuator>"), "type='robot'");
  scene.set("BODIES", "target_j", 20);
  scene.go_to(2);
  const double sag = rod_mass().mass_kg * kMjcfGravity / 2 * std::cos(glm::radians(20.0)) / 3000;
  CHECK(std::abs(scene.get("j", "value") - 20 - glm::degrees(sag)) < 0.05);
}

// A rod on a slide along z, which each row lets stand or move within 0.5 s, and whether it does without the flag.
struct Switch {
  const char* flag;
  std::string joint, more;
  double moved_m = 0, moved_without_m = 0;  // with the flag, and without it
};

TEST_CASE("of two geoms of MJCF the larger friction counts, and none only if both have the condim 1") {
  constexpr double kSlope_deg = 30, kTime_s = 0.5;  // tan 0.577
  const double free_m = kMjcfGravity * std::sin(glm::radians(kSlope_deg)) * kTime_s * kTime_s / 2;
  struct Row {
    const char *floor, *box;
    double friction;
  };
  for (const Row& row :
       {Row{"friction='0.2'", "friction='0.9'", 0.9}, Row{"friction='0.9'", "friction='0.2'", 0.9},
        Row{"friction='0.1'", "friction='0.3'", 0.3}, Row{"friction='0.9'", "friction='0.9' condim='1'", 0.9},
        Row{"friction='0.9' condim='1'", "friction='0.9' condim='1'", 0}, Row{"", "", 1}}) {
    CAPTURE(std::string(row.floor));
    CAPTURE(std::string(row.box));
    MovingScene scene =
        mjcf_scene("<worldbody><geom type='plane' size='9 9 1' euler='0 30 0' " + std::string(row.floor) +
                   "/><body name='box' euler='0 30 0' pos='0.05 0 0.0866025403784'><freejoint/><geom "
                   "type='box' size='0.1 0.1 0.1' " +
                   row.box + "/></body></worldbody>");
    const glm::dvec3 before = scene.position("box");
    scene.go_to(kTime_s);
    const double slides = std::max(0.0, 1 - row.friction / std::tan(glm::radians(kSlope_deg)));
    // A semi-implicit step more, and the first steps, in which the box comes to the floor.
    const double tolerance_m = kMjcfGravity * kTime_s * 2e-3;
    CHECK(std::abs(glm::length(scene.position("box") - before) - slides * free_m) < tolerance_m);
  }
}

TEST_CASE("settotalmass of an MJCF model scales masses and inertias") {
  constexpr double kTotal_kg = 8, kScale = kTotal_kg / (1 + 3), kTime_s = 6;
  MovingScene scene = mjcf_scene(
      "<compiler settotalmass='8'/><worldbody><body name='a' pos='0 0 1'><joint name='s' type='slide' axis='0 0 1' "
      "stiffness='400' damping='80'/><geom type='box' size='0.1 0.1 0.1' mass='1'/></body><body name='b' pos='0 5 1'>"
      "<joint name='t' axis='0 0 1'/><inertial pos='0 0 0' mass='3' diaginertia='2 2 2'/></body></worldbody>"
      "<actuator><motor joint='t'/></actuator>");
  scene.set("BODIES", "target_t", 0.1);
  scene.go_to(kTime_s);
  CHECK(std::abs(scene.get("s", "value") + 1 * kScale * kMjcfGravity / 400) < 1e-9);
  const double turned = 0.1 / (2 * kScale) * kTime_s * (kTime_s + 1e-3) / 2;
  CHECK(std::abs(scene.get("t", "value") - glm::degrees(turned)) < 1e-9);
}

// What a motor of 1 N m or 1 N and the time of 1 s tell of a joint: the inertia about its axis, or the mass.
double resistance(const std::string& compiler, const std::string& joint, const std::string& body) {
  constexpr double kTime_s = 1;
  MovingScene scene =
      mjcf_scene("<compiler " + compiler + "/><worldbody><body name='a' pos='0 0 1'><joint name='j' " + joint + "/>" +
                 body + "</body></worldbody><option gravity='0 0 0'/><actuator><motor joint='j'/></actuator>");
  scene.set("BODIES", "target_j", 1);
  scene.go_to(kTime_s);
  const double way = scene.get("j", "value");
  const double unit = contains(joint, "slide") ? way : glm::radians(way);
  return kTime_s * (kTime_s + 1e-3) / 2 / unit;
}

// The masses and moments are those that MuJoCo 4.0.0 compiles (MjModel.body_mass, body_inertia and body_ipos).
TEST_CASE("bounds and balance of masses of an MJCF model are those of MuJoCo") {
  constexpr double kShare = 1e-9;
  const std::string given = "<inertial pos='0 0 0' mass='0.5' diaginertia='0.01 0.02 0.05'/>";
  const std::string full = "<inertial pos='0 0 0' mass='0.5' fullinertia='0.01 0.02 0.05 0.001 0.002 0.003'/>";
  const std::string ball = "<geom type='sphere' size='0.1' mass='0.2' contype='0' conaffinity='0'/>";
  struct Row {
    std::string compiler, body;
    double mass_kg;
    glm::dvec3 moments_kg_m2;
  };
  const Row rows[] = {
      {"balanceinertia='true'", given, 0.5, glm::dvec3(0.08 / 3)},
      {"balanceinertia='true'", full, 0.5, glm::dvec3(0.08 / 3)},
      {"balanceinertia='true'", "<inertial pos='0 0 0' mass='0.5' diaginertia='0.01 0.02 0.03001'/>", 0.5,
       glm::dvec3(0.06001 / 3)},
      {"balanceinertia='true'",
       "<inertial pos='0 0 0' mass='0.5' diaginertia='0.01 0.02 0.03'/>",
       0.5,
       {0.01, 0.02, 0.03}},
      {"balanceinertia='true'", ball, 0.2, glm::dvec3(0.0008)},
      {"boundmass='1'", ball, 1, glm::dvec3(0.0008)},
      {"boundmass='0.1'", ball, 0.2, glm::dvec3(0.0008)},
      {"boundmass='1' boundinertia='0.03'", ball, 1, glm::dvec3(0.03)},
      {"boundinertia='0.03'", given, 0.5, {0.03, 0.03, 0.05}},
      {"boundinertia='0.03' balanceinertia='true'", given, 0.5, {0.03, 0.03, 0.05}},
      {"boundmass='1'/><compiler boundmass='2'", ball, 2, glm::dvec3(0.0008)},
      {"boundmass='-1' boundinertia='-1'", ball, 0.2, glm::dvec3(0.0008)},
      {"boundinertia='0.03' boundmass='1' settotalmass='10'", given, 10, glm::dvec3(0.3, 0.3, 0.5)},
  };
  for (const Row& row : rows) {
    CAPTURE(row.compiler);
    CAPTURE(row.body);
    CHECK(std::abs(resistance(row.compiler, "type='slide' axis='0 0 1'", row.body) / row.mass_kg - 1) < kShare);
    const std::string axes[] = {"1 0 0", "0 1 0", "0 0 1"};
    for (int i = 0; i < 3; ++i) {
      const double moment = resistance(row.compiler, "axis='" + axes[i] + "'", row.body);
      CHECK(std::abs(moment / row.moments_kg_m2[i] - 1) < kShare);
    }
  }
}

TEST_CASE("a body without mass gets that of the bounds of an MJCF model") {
  // MuJoCo puts it at the place of the body in its own frame: 1 m below the joint, which is at the body's origin.
  const std::string bounds = "boundmass='2' boundinertia='0.5'";
  constexpr double kShare = 1e-9;
  CHECK(std::abs(resistance(bounds, "axis='1 0 0'", "") / (0.5 + 2 * 1) - 1) < kShare);
  CHECK(std::abs(resistance(bounds, "axis='0 0 1'", "") / 0.5 - 1) < kShare);
  CHECK(contains(error_of([&] { resistance("boundmass='2' balanceinertia='maybe'", "axis='1 0 0'", ""); }),
                 "balanceinertia \"maybe\", expected \"true\" or \"false\""));
}

TEST_CASE("flags of an MJCF model switch its parts off") {
  constexpr double kTime_s = 0.5, kFall_m = kMjcfGravity * kTime_s * kTime_s / 2;
  // Semi-implicit steps fall by g t h / 2 more. A damped slide reaches m g / c within some ms, a spring of w = 20 / s
  // swings between 0 and twice its sag, and a servo creeps to its sag of m g / kp at the rate kp / kv.
  const double tolerance_m = kMjcfGravity * kTime_s * 1e-3;
  const double weight_n = rod_mass().mass_kg * kMjcfGravity, rate = 20, sag_m = kMjcfGravity / (rate * rate);
  const std::string stiffness = format_number(rod_mass().mass_kg * rate * rate), heavy = format_number(100 * weight_n);
  const Switch all[] = {
      {"gravity", "", "", 0, -kFall_m},
      {"limit", "range='-0.1 0.1'", "", -kFall_m, -0.1},
      {"constraint", "range='-0.1 0.1'", "", -kFall_m, -0.1},
      {"frictionloss", "frictionloss='" + heavy + "'", "", -kFall_m, 0},
      {"constraint", "frictionloss='" + heavy + "'", "", -kFall_m, 0},
      {"damper", "damping='" + heavy + "'", "", -kFall_m, -kTime_s / 100},
      {"passive", "damping='" + heavy + "'", "", -kFall_m, -kTime_s / 100},
      {"spring", "stiffness='" + stiffness + "'", "", -kFall_m, -sag_m * (1 - std::cos(rate * kTime_s))},
      {"passive", "stiffness='" + stiffness + "'", "", -kFall_m, -sag_m * (1 - std::cos(rate * kTime_s))},
      {"actuation", "", "<actuator><position joint='j' kp='" + heavy + "' kv='" + heavy + "'/></actuator>", -kFall_m,
       -0.01 * (1 - std::exp(-kTime_s))},
      {"contact", "", "<worldbody><geom type='plane' size='9 9 1' pos='0 0 1.85'/></worldbody>", -kFall_m, -0.1},
      {"constraint", "", "<worldbody><geom type='plane' size='9 9 1' pos='0 0 1.85'/></worldbody>", -kFall_m, -0.1},
  };
  for (const Switch& each : all) {
    CAPTURE(each.flag);
    CAPTURE(each.joint + each.more);
    const std::string body = "<worldbody><body name='rod' pos='0 0 2'><joint name='j' type='slide' axis='0 0 1' " +
                             each.joint +
                             "/><geom type='capsule' fromto='0 0 0 1 0 0' size='0.05'/></body></worldbody>" + each.more;
    for (const bool is_off : {true, false}) {
      CAPTURE(is_off);
      const std::string flag = "<option><flag " + std::string(each.flag) + "='disable'/></option>";
      MovingScene scene = mjcf_scene((is_off ? flag : "") + body);
      scene.go_to(kTime_s);
      CHECK(std::abs(scene.position("rod").z - 2 - (is_off ? each.moved_m : each.moved_without_m)) < tolerance_m);
    }
  }
}

TEST_CASE("an equality that a flag of an MJCF model switches off holds nothing") {
  const std::string pair =
      "<worldbody><body name='a'><joint name='a' axis='0 1 0'/><geom size='0.1' pos='1 0 0'/></body><body name='b' "
      "pos='0 5 0'><joint name='b' axis='0 0 1'/><geom size='0.1' pos='1 0 0'/></body></worldbody>"
      "<equality><joint joint1='b' joint2='a'/></equality>";
  for (const char* const flag : {"equality", "constraint"}) {
    for (const bool is_off : {true, false}) {
      MovingScene scene =
          mjcf_scene((is_off ? "<option><flag " + std::string(flag) + "='disable'/></option>" : "") + pair);
      scene.go_to(0.2);
      CHECK(scene.get("a", "value") > 5);
      CHECK((std::abs(scene.position("b").z) < 1e-9));
      const glm::dvec3 x = scene.pose("b")[0];
      CHECK((std::abs(std::atan2(x.y, x.x)) < 1e-12) == is_off);
    }
  }
}

TEST_CASE("each kind of MJCF content that physics does otherwise gives one warning") {
  MovingScene scene = mjcf_scene(
      "<option><flag filterparent='disable'/></option><worldbody><geom type='plane' size='1 1 1' friction='0.5'/>"
      "<body name='b' gravcomp='1'>"
      "<joint name='j'/><geom type='sphere' size='0.1' condim='4' solref='0.01 1'/>"
      "<body name='c' pos='0 0 1'><joint type='ball' range='0 30'/><geom type='sphere' "
      "size='0.1'/></body></body></worldbody>"
      "<actuator><muscle joint='j'/><motor site='s'/></actuator><contact><pair geom1='a' geom2='b'/></contact>");
  for (const char* const what :
       {"\"gravcomp\" of a body is not taken over", "friction against turning and rolling is not",
        "\"solref\" of a geom is not", "\"range\" of a ball joint is not", "actuator <muscle> is not",
        "actuator of something else than a joint is not", "<flag filterparent> of <option> is not",
        "<pair> of contacts is not"}) {
    CAPTURE(what);
    CHECK(mjcf_warns(scene, what));
  }
}

TEST_CASE("mistakes in the physics of MJCF models name their place") {
  const auto wrong = [](const std::string& content) { return error_of([&] { mjcf_scene(content); }); };
  CHECK(contains(wrong(rod("damping='-1'")), "m.xml:2:"));
  CHECK(contains(wrong(rod("damping='-1'")), "element <joint> has a damping below 0"));
  CHECK(contains(wrong(rod("", "<actuator><motor joint='j' gear='0'/></actuator>")), "has a gear of 0"));
  CHECK(contains(wrong(rod("", "<option timestep='7'/>")), "has a timestep of 7 s"));
  CHECK(contains(wrong(rod("", "<option><flag gravity='off'/></option>")),
                 "element <flag> has gravity=\"off\", expected enable or disable"));
  CHECK(contains(wrong("<worldbody><body name='b'><freejoint/><geom type='sphere' size='1' density='0'/></body>"
                       "</worldbody>"),
                 "link \"b\" moves and has no mass"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
