// Elements that push bodies, against closed formulas: forces at points of bodies and links, thrusters and rotors.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include <simvis/simulation.h>
#include "elements/dynamics/world/engine_module.h"
#include "exchange/messages/types/geometry_types.h"
#include "tests/support/moved_body.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

const std::string kNoGravity = physics("gravity='0 0 0'");
constexpr double kMass_kg = 2;
// Moments of the box below; the principal axes are those of the part.
constexpr double kMoment_kg_m2 = 0.5;
const std::string kBoxBody = "shape='box' mass='2' inertia='0.5 0.5 0.5'";
// Sums of a thousand steps: each rounds by 2^-53 of the value some times.
constexpr double kRelativeRounding = 1e-12;

std::string pushed_box(const std::string& force, const std::string& pose = "0 0 0 0 0 0") {
  return kNoGravity + body("BOX", "shape='box' size='0.4 0.4 0.4' pose_offset='" + pose + "'", kBoxBody) +
         "<element name='PUSH' insert_at='BOX' " + force + "/>\n";
}

TEST_CASE("a force accelerates a body by F / m, the same at any rate of frames") {
  constexpr double kForce_n = 3, kTime_s = 1;
  std::vector<double> first;
  for (const double period_s : {0.001, 0.02, 0.1, 0.25}) {
    CAPTURE(period_s);
    MovedBody box(pushed_box("type='force' force_x='3'", "1 2 3 10 20 90"), "BOX");
    box.scene.run(0, kTime_s, period_s);
    const StepMotion::At at = box.motion();
    CHECK(std::abs(at.velocity_m_s.x / (kForce_n / kMass_kg * kTime_s) - 1) < kRelativeRounding);
    // Semi-implicit steps: x = F/m (t^2 + t h) / 2.
    const double way_m = kForce_n / kMass_kg * (kTime_s * kTime_s + kTime_s * kStep_s) / 2;
    CHECK(glm::length(at.center_m - glm::dvec3(1 + way_m, 2, 3)) < kRelativeRounding * way_m + 1e-14);
    CHECK(glm::length(at.angular_velocity_rad_s) < 1e-15);
    if (first.empty()) first = box.scene.values();
    CHECK(box.scene.values() == first);
  }
}

TEST_CASE("force and torque in the frame of the body turn with it, and add up") {
  // x of the part is y of the world.
  MovedBody box(pushed_box("type='force' frame='body' force_x='4' torque_z='0.1'", "0 0 0 0 0 90"), "BOX");
  box.scene.run(0, 0.001, 0.001);
  const StepMotion::At at = box.motion();
  CHECK(glm::length(at.velocity_m_s - glm::dvec3(0, 4 / kMass_kg * kStep_s, 0)) < 1e-15);
  CHECK(glm::length(at.angular_velocity_rad_s - glm::dvec3(0, 0, 0.1 / kMoment_kg_m2 * kStep_s)) < 1e-15);
}

TEST_CASE("a torque spins a free body by T / I, at an angle of T t^2 / 2 I") {
  constexpr double kTorque_nm = 0.3, kTime_s = 2;
  MovedBody box(pushed_box("type='force' torque_z='0.3'"), "BOX");
  box.scene.run(0, kTime_s, 0.05);
  const double speed = kTorque_nm / kMoment_kg_m2 * kTime_s;
  CHECK(std::abs(box.motion().angular_velocity_rad_s.z / speed - 1) < kRelativeRounding);
  const double angle = glm::degrees(speed * (kTime_s + kStep_s) / 2);
  // Quaternions are renormalized in each step: 2000 roundings of an angle.
  CHECK(std::abs(box.scene.get("BOX_BODY", "yaw") - angle) < 1e-9);
  CHECK(glm::length(box.motion().center_m) < 1e-15);
}

TEST_CASE("a force at an offset point also turns the body, about the centre of mass") {
  constexpr double kForce_n = 0.2, kArm_m = 0.1, kTime_s = 1;
  // In the frame of the body its torque stays the same.
  MovedBody box(pushed_box("type='force' frame='body' point='0.1 0 0' force_y='0.2'"), "BOX");
  box.scene.run(0, kTime_s, 0.1);
  CHECK(std::abs(box.motion().angular_velocity_rad_s.z / (kForce_n * kArm_m / kMoment_kg_m2 * kTime_s) - 1) <
        kRelativeRounding);
  // In the world the point has moved on: the torque is F arm cos(angle) with angle'' = F arm cos(angle) / I.
  MovedBody other(pushed_box("type='force' point='0.1 0 0' force_y='20'"), "BOX");
  other.scene.run(0, kTime_s, 0.1);
  const double w = other.motion().angular_velocity_rad_s.z, angle = glm::radians(other.scene.get("BOX_BODY", "yaw"));
  // Energy: I w^2 / 2 = F arm sin(angle). Steps of order 1 miss it by w h / 2 of the torque's work.
  const double work = 20 * kArm_m * std::sin(angle);
  CHECK(std::abs(kMoment_kg_m2 * w * w / 2 - work) < std::abs(w) * kStep_s * 20 * kArm_m);
  CHECK(std::abs(work) > 0.1);
}

TEST_CASE("a force acts on a link: about its joint, at a point of a link behind a fixed joint too") {
  const auto robot = [](const std::string& urdf, const std::string& force) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "r.urdf") << urdf;
    return MovingScene(kNoGravity +
                           "<part name='R' insert_at='ROOT' file='r.urdf' pose_offset='0 0 2 0 0 0'/>\n"
                           "<element type='robot' name='ROBOT' insert_at='R' control='none'/>\n"
                           "<element type='force' name='PUSH' frame='body' " +
                           force + "/>\n",
                       folder.path());
  };
  // A bar of 1 m and 1 kg turns about its end: I = 1/12 + 1/4. A force along z turns it against y.
  MovingScene bar = robot(kPendulum, "insert_at='bar' point='1 0 0' force_z='0.2'");
  constexpr double kTime_s = 1;
  bar.run(0, kTime_s, 0.05);
  const double angle = -0.2 / (1.0 / 12 + 0.25) * (kTime_s * kTime_s + kTime_s * kStep_s) / 2;
  CHECK(std::abs(glm::radians(bar.get("swing", "value")) / angle - 1) < kRelativeRounding);
  // The grip stands 0.5 m along x of the lower link.
  MovingScene grip = robot(kArm, "insert_at='grip' force_z='1' point='0.1 0 0'"),
              lower = robot(kArm, "insert_at='lower' force_z='1' point='0.6 0 0'");
  grip.run(0, 0.3, 0.05);
  lower.run(0, 0.3, 0.05);
  CHECK(std::abs(grip.get("elbow", "value")) > 1);
  CHECK(grip.get("elbow", "value") == lower.get("elbow", "value"));
  CHECK(grip.get("shoulder", "value") == lower.get("shoulder", "value"));
}

// Bodies, free bases of robots and links on a slide.
TEST_CASE("the world takes a push for one step, from any carrier") {
  const auto world = dynamics_engine().make_world({.step_s = kStep_s, .iterations = 50});
  const MassProperties mass{.mass_kg = kMass_kg, .inertia_kg_m2 = glm::dmat3(kMoment_kg_m2)};
  const std::vector<CollisionShape> ball{{.kind = CollisionKind::sphere, .half_m = glm::dvec3(0.1)}};
  const WorldLink body{.id = world->add_body({.mass = mass, .shapes = ball})};
  ArticulationDesc free;
  free.fixed_base = false;
  free.mass = mass;
  free.world_from_base[3].y = 10;
  const WorldLink base{.id = world->add_articulation(free)};
  ArticulationDesc slide;
  slide.mass = mass;
  slide.links = {{.joint = JointKind::prismatic, .axis = {1, 0, 0}, .mass = mass}};
  slide.world_from_base[3].y = 20;
  const WorldLink link{.id = world->add_articulation(slide), .link = 0};
  for (const WorldLink& each : {body, base, link}) {
    CAPTURE(each.id);
    world->push(each, {.force_n = {5, 0, 0}});
    world->push(each, {.force_n = {-2, 0, 0}});
    REQUIRE_FALSE(world->step());
    CHECK(std::abs(world->state(each).velocity_m_s.x - 3 / kMass_kg * kStep_s) < 1e-15);
    REQUIRE_FALSE(world->step());
    CHECK(std::abs(world->state(each).velocity_m_s.x - 3 / kMass_kg * kStep_s) < 1e-15);
  }
}

TEST_CASE("a force wakes a sleeping body, and a push of nothing does not") {
  const std::string box =
      body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.1 0 0 0'", "mass='1' shape='box' friction='0.7'");
  MovingScene scene(kPhysics + ground() + box + "<element type='force' name='PUSH' insert_at='BOX'/>");
  scene.run(0, 4, 0.1);
  const double slept = scene.position("BOX").x;
  // Friction holds 0.7 * 0.7 of the weight.
  scene.set("PUSH", "force_x", 0.4 * kGravity_m_s2);
  scene.run(4, 6, 0.1);
  CHECK(std::abs(scene.position("BOX").x - slept) < 1e-6);
  scene.set("PUSH", "force_x", 0.6 * kGravity_m_s2);
  scene.run(6, 7, 0.1);
  // It slides by (0.6 - 0.49) g t^2 / 2, and friction by 1e-4 of that exactly.
  CHECK(std::abs(scene.position("BOX").x - slept - 0.11 * kGravity_m_s2 / 2) < 0.01 * 0.11 * kGravity_m_s2);
  const auto world = dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -10}, .step_s = kStep_s, .iterations = 50});
  world->add_body({.kind = BodyKind::fixed, .shapes = {{.kind = CollisionKind::plane}}});
  const std::vector<CollisionShape> cube{{.kind = CollisionKind::box, .half_m = glm::dvec3(0.1)}};
  const WorldLink resting{.id = world->add_body({.world_from_body = glm::translate(glm::dmat4(1), {0, 0, 0.1}),
                                                 .mass = {.mass_kg = 1, .inertia_kg_m2 = glm::dmat3(0.01)},
                                                 .shapes = cube})};
  for (int i = 0; i < 3000; ++i) {
    world->push(resting, {});
    REQUIRE_FALSE(world->step());
  }
  CHECK(world->awake() == 0);
  world->push(resting, {.force_n = {1, 0, 0}});
  CHECK(world->awake() == 1);
}

TEST_CASE("a Wrench by DDS acts for its timeout, and values that are set hold") {
  const auto wrench = [](double force, double torque) { return ros::Wrench{{force, 0, 0}, {0, 0, torque}}; };
  MovedBody box(pushed_box("type='force' timeout='0.5'"), "BOX");
  const CommandInput input{"/PUSH/wrench", &ros::describe<ros::Wrench>()};
  box.scene.command(input, ros::encode(wrench(2, 0.1)));
  box.scene.run(0, 2, 0.05);
  CHECK(std::abs(box.motion().velocity_m_s.x - 2 / kMass_kg * 0.5) < kRelativeRounding);
  CHECK(std::abs(box.motion().angular_velocity_rad_s.z - 0.1 / kMoment_kg_m2 * 0.5) < kRelativeRounding);
  CHECK(box.scene.get("PUSH", "force_x") == 0);
  box.scene.set("PUSH", "force_x", 1);
  box.scene.run(2, 4, 0.05);
  CHECK(std::abs(box.motion().velocity_m_s.x - (2 / kMass_kg * 0.5 + 1 / kMass_kg * 2)) < kRelativeRounding);
  const std::vector<double> before = box.scene.values();
  const auto refused = [&](const std::string& bytes) {
    const std::string why = error_of([&] { box.scene.command(input, bytes); });
    CHECK(box.scene.values() == before);
    return why;
  };
  CHECK(contains(refused(ros::encode(wrench(std::numeric_limits<double>::quiet_NaN(), 0))), "not finite"));
  CHECK(contains(refused(ros::encode(wrench(1e13, 0))), "PUSH.force_x: "));
  ros::WrenchStamped late{{}, wrench(1, 0)};
  late.header.stamp.sec = 1;
  const CommandInput stamped{"/PUSH/wrench", &ros::describe<ros::WrenchStamped>()};
  CHECK(contains(error_of([&] { box.scene.command(stamped, ros::encode(late)); }), "before the simulated time"));
  late.header.stamp.sec = 4;
  box.scene.command(stamped, ros::encode(late));
  CHECK(box.scene.get("PUSH", "force_x") == 1);
}

TEST_CASE("a thruster follows its command with a lag, and its impulse is exact in steps of any length") {
  constexpr double kThrust_n = 6, kLag_s = 0.03, kTime_s = 0.2;
  for (const double step_ms : {0.25, 1.0, 10.0}) {
    CAPTURE(step_ms);
    MovedBody box(physics("gravity='0 0 0' step='" + format_number(step_ms) + "'") +
                      body("BOX", "shape='box' size='0.4 0.4 0.4'", kBoxBody) +
                      "<element type='thruster' name='JET' insert_at='BOX' axis='0 2 0' time_constant='0.03'/>",
                  "BOX");
    box.scene.run(0, 0.1, 0.1);
    box.scene.set("JET", "thrust", kThrust_n);
    box.scene.run(0.1, 0.1 + kTime_s, 0.1);
    // The integral of T (1 - e^(-t / lag)), then of -T + (T + T reached) e^(-t / lag).
    const double reached = -std::expm1(-kTime_s / kLag_s), there = kThrust_n * (kTime_s - kLag_s * reached);
    CHECK(std::abs(box.motion().velocity_m_s.y / (there / kMass_kg) - 1) < kRelativeRounding);
    box.scene.set("JET", "thrust", -kThrust_n);
    box.scene.run(0.3, 0.3 + kTime_s, 0.1);
    const double back = kThrust_n * (-kTime_s + (1 + reached) * kLag_s * reached);
    CHECK(std::abs(box.motion().velocity_m_s.y - (there + back) / kMass_kg) < kRelativeRounding * there / kMass_kg);
  }
}

TEST_CASE("a rotor lifts by the square of its speed, which follows the command with a lag") {
  constexpr double kLift_n_s2 = 1e-5, kDrag_nm_s2 = 2e-7, kLag_s = 0.05, kTime_s = 0.3;
  for (const double step_ms : {0.25, 1.0, 10.0}) {
    CAPTURE(step_ms);
    MovedBody box(physics("gravity='0 0 0' step='" + format_number(step_ms) + "'") +
                      body("BOX", "shape='box' size='0.4 0.4 0.4'", kBoxBody) +
                      "<element type='rotor' name='ROTOR' insert_at='BOX' thrust_constant='1e-5' "
                      "torque_constant='2e-7' time_constant='0.05' speed='9000'/>",
                  "BOX");
    const double slow = glm::radians(9000.0), fast = glm::radians(30000.0);
    // At the start the speed is there.
    box.scene.run(0, 0.1, 0.1);
    CHECK(std::abs(box.motion().velocity_m_s.z / (kLift_n_s2 * slow * slow * 0.1 / kMass_kg) - 1) < kRelativeRounding);
    box.scene.set("ROTOR", "speed", 30000);
    box.scene.run(0.1, 0.1 + kTime_s, 0.1);
    // The integral of (a + b e^(-t / lag))^2.
    const double b = slow - fast, once = -kLag_s * std::expm1(-kTime_s / kLag_s),
                 twice = -kLag_s / 2 * std::expm1(-2 * kTime_s / kLag_s);
    const double squares = slow * slow * 0.1 + fast * fast * kTime_s + 2 * fast * b * once + b * b * twice;
    CHECK(std::abs(box.motion().velocity_m_s.z / (kLift_n_s2 * squares / kMass_kg) - 1) < kRelativeRounding);
    // A rotor that turns counter-clockwise turns its body clockwise.
    CHECK(std::abs(box.motion().angular_velocity_rad_s.z / (-kDrag_nm_s2 * squares / kMoment_kg_m2) - 1) <
          kRelativeRounding);
  }
}

TEST_CASE("pushes do not depend on the order of their commands, and a restart repeats them") {
  // (0.1 + 0.2) + 0.3 and (0.3 + 0.2) + 0.1 are two numbers.
  const auto force = [](const std::string& name, const std::string& force_x) {
    return "<element type='force' name='" + name + "' insert_at='BOX' force_x='" + force_x + "'/>\n";
  };
  const std::string a = force("A1", "0.1"), b = force("A2", "0.2"), c = force("A3", "0.3"),
                    jet = "<element type='thruster' name='B' insert_at='BOX' point='0.1 0.2 0.3' time_constant='1'/>\n";
  const std::string box = kNoGravity + body("BOX", "shape='box' size='0.4 0.4 0.4'", kBoxBody);
  MovedBody one(box + a + b + c + jet, "BOX"), other(box + jet + c + b + a, "BOX");
  const auto run = [](MovedBody& box, double from_s) {
    box.scene.set("B", "thrust", 0.3);
    box.scene.run(from_s, from_s + 0.5, 0.1);
    box.scene.set("B", "thrust", 1);
    box.scene.run(from_s + 0.5, from_s + 1, 0.1);
    return box.motion().center_m;
  };
  const glm::dvec3 first = run(one, 0);
  CHECK(run(other, 0) == first);
  one.scene.set("B", "thrust", 0.3);
  one.scene.set("PHYSICS", "restarts", 1);
  one.scene.go_to(1.1);
  CHECK(run(one, 1.1) == first);
}

TEST_CASE("a body that is removed is no longer pushed, and one that comes is") {
  Simulation simulation = Simulation::from_string(pushed_box("type='force' force_x='3'"));
  simulation.step();
  simulation.execute("<remove name='BOX_BODY'/>");
  CHECK_NOTHROW(simulation.step());
  simulation.execute("<element type='body' name='NEW' insert_at='BOX' " + kBoxBody + "/>");
  for (int i = 0; i < 3; ++i) simulation.step();
  CHECK(simulation.get("NEW", "x") > 0);
}

TEST_CASE("what cannot be pushed, and wrong numbers, are errors with their place") {
  const auto wrong = [](const std::string& before, const std::string& element) {
    return error_of([&] { MovingScene scene(kPhysics + before + "<element name='E' " + element + "/>"); });
  };
  const std::string box = body("BOX", "shape='box' size='1 1 1'", "mass='1'");
  for (const std::string type : {"force", "drag", "buoyancy", "thruster", "rotor"}) {
    CAPTURE(type);
    const std::string at = "type='" + type + "' insert_at=";
    for (const std::string kind : {"static", "kinematic"}) {
      CHECK(contains(wrong(body("WALL", "shape='box' size='1 1 1'", "kind='" + kind + "'"), at + "'WALL'"),
                     "no force moves \"WALL\", where element \"WALL_BODY\" stands"));
    }
    CHECK(contains(wrong(box, at + "'ROOT'"), "no body stands at \"ROOT\""));
    CHECK(contains(error_of([&] { MovingScene("<element name='E' " + at + "'ROOT'/>"); }), "the scene has no physics"));
  }
  const std::string on_box = "insert_at='BOX' type=";
  CHECK(contains(wrong(box, on_box + "'buoyancy' density='-1'"), "density"));
  CHECK(contains(wrong(box, on_box + "'drag' density='-1'"), "density"));
  CHECK(contains(wrong(box, on_box + "'drag' area='nan'"), "area"));
  CHECK(contains(wrong(box, on_box + "'force' force_x='nan'"), "force_x"));
  CHECK(contains(wrong(box, on_box + "'force' point='0 inf 0'"), "point"));
  CHECK(contains(wrong(box, on_box + "'force' frame='link'"), "frame"));
  CHECK(contains(wrong(box, on_box + "'force' topic='wrench'"), "topic"));
  CHECK(contains(wrong(box, on_box + "'thruster' axis='0 0 0'"), "\"axis\" has no direction"));
  CHECK(contains(wrong(box, on_box + "'rotor' speed='-1'"), "speed"));
  CHECK(contains(wrong(box, on_box + "'rotor' time_constant='-1'"), "time_constant"));
  CHECK(contains(wrong(box, on_box + "'drag' wind='BOX_BODY'"), "expected the name of an element of type wind"));
  CHECK(contains(wrong(box, "type='wind' insert_at='ROOT' gust='-1'"), "gust"));
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "r.urdf") << kArm;
  const auto robot = [&](const std::string& element) {
    return error_of([&] {
      MovingScene(kPhysics +
                      "<part name='R' insert_at='ROOT' file='r.urdf'/>"
                      "<element type='robot' name='ROBOT' insert_at='R' control='none'/><element name='E' " +
                      element + "/>",
                  folder.path());
    });
  };
  CHECK(contains(robot("type='force' insert_at='R'"), "no force moves \"R\", where element \"ROBOT\" stands"));
  CHECK(contains(robot("type='buoyancy' insert_at='upper'"), "have no volume"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
