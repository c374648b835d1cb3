// Bodies that hold together and let go: poses, momentum, carrying, and errors.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "elements/dynamics/world/engine_module.h"
#include "tests/support/moved_body.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// The passes of a step end once no row changes a speed by more than this.
constexpr double kSolved_m_s = 1e-8;
// A step takes back this share of an error of the pose.
constexpr double kTakenBack = 0.2;

struct Momentum {
  double mass_kg = 0;
  glm::dvec3 linear{0}, angular{0};  // about the origin of the world
};

// A body, or the base of a robot, of this mass and moment.
struct Held {
  WorldLink link;
  double mass_kg, moment_kg_m2;
};

Momentum momentum_of(const DynamicsWorld& world, const std::vector<Held>& bodies) {
  Momentum sum;
  for (const Held& each : bodies) {
    const BodyState now = world.state(each.link);
    const glm::dvec3 linear = each.mass_kg * now.velocity_m_s;
    sum.mass_kg += each.mass_kg;
    sum.linear += linear;
    sum.angular += glm::cross(now.center_m, linear) + each.moment_kg_m2 * now.angular_velocity_rad_s;
  }
  return sum;
}

MassProperties ball_mass(double mass_kg, double moment_kg_m2) {
  return {.mass_kg = mass_kg, .center_m = {0, 0, 0}, .inertia_kg_m2 = glm::dmat3(moment_kg_m2)};
}

// Adds what flies, a loose body or a robot with a free base, with the shape of a ball.
Held add_flying(DynamicsWorld& world, bool is_robot, const glm::dvec3& at, const glm::dvec3& velocity_m_s,
                const glm::dvec3& turn_rad_s, double mass_kg) {
  const double moment = 0.01 * mass_kg;
  const std::vector<CollisionShape> shapes{{.kind = CollisionKind::sphere, .half_m = glm::dvec3(0.2)}};
  if (!is_robot) {
    return {{.id = world.add_body({.world_from_body = glm::translate(glm::dmat4(1), at),
                                   .mass = ball_mass(mass_kg, moment),
                                   .shapes = shapes,
                                   .velocity_m_s = velocity_m_s,
                                   .angular_velocity_rad_s = turn_rad_s})},
            mass_kg,
            moment};
  }
  ArticulationDesc desc{.fixed_base = false,
                        .world_from_base = glm::translate(glm::dmat4(1), at),
                        .mass = ball_mass(mass_kg, moment),
                        .shapes = shapes};
  const Held robot{{.id = world.add_articulation(desc)}, mass_kg, moment};
  world.push(robot.link, {.force_n = mass_kg / kStep_s * velocity_m_s, .torque_nm = moment / kStep_s * turn_rad_s});
  return robot;
}

glm::dmat4 between(const DynamicsWorld& world, const WorldLink& a, const WorldLink& b) {
  return glm::inverse(world.state(a).world_from_body) * world.state(b).world_from_body;
}

double distance(const glm::dmat4& a, const glm::dmat4& b) {
  double worst = 0;
  for (int c = 0; c < 4; ++c) worst = std::max(worst, glm::length(glm::dvec3(a[c] - b[c])));
  return worst;
}

// The axes: each of the two a loose body or a robot; apart, touching or overlapping.
TEST_CASE("attaching and letting go changes neither poses nor momentum, and in between the pose stays") {
  for (const bool a_robot : {false, true}) {
    for (const bool b_robot : {false, true}) {
      for (const double apart_m : {0.7, 0.4, 0.35}) {
        CAPTURE(a_robot);
        CAPTURE(b_robot);
        CAPTURE(apart_m);
        const auto world = dynamics_engine().make_world({.step_s = kStep_s, .iterations = 50});
        const Held a = add_flying(*world, a_robot, {0, 0, 0}, {1, 0.5, 0}, {0, 0, 1}, 2);
        const Held b = add_flying(*world, b_robot, {apart_m, 0, 0}, {1.3, -0.2, 0.4}, {1, 0, 0}, 0.5);
        REQUIRE_FALSE(world->step());
        const Momentum before = momentum_of(*world, {a, b});
        const glm::dmat4 pose_a = world->state(a.link).world_from_body, held = between(*world, a.link, b.link);
        const std::size_t grip = world->add_constraint(
            {.kind = ConstraintDesc::Kind::fixed, .a = a.link, .b = b.link, .a_from_joint = held, .collide = false});
        CHECK(world->state(a.link).world_from_body == pose_a);
        double stretch = 0;
        for (int i = 0; i < 1000; ++i) {
          REQUIRE_FALSE(world->step());
          if (i > 0) stretch = std::max(stretch, distance(between(*world, a.link, b.link), held));
        }
        const Momentum after = momentum_of(*world, {a, b});
        // Impulses act on both at one place. A step rounds momenta of some kg m/s by 2^-53, and moves the place of each
        // body along its speed, so that the angular momentum stays too. Bullet turns bodies with their inertia of the
        // step before; balls have the same along all axes.
        CHECK(glm::length(after.linear - before.linear) < 1e-12);
        CHECK(glm::length(after.angular - before.angular) < 1e-11);
        // Both turn at w about a point at most 0.7 m away. Positions follow chords instead of arcs, w^2 h^2 r / 2 in a
        // step, of which the rows take back a fifth; the passes leave 1e-8 m/s.
        const double w = glm::length(world->state(a.link).angular_velocity_rad_s);
        const double bound = (w * w * kStep_s * kStep_s * 0.7 / 2 + kSolved_m_s * kStep_s) / kTakenBack;
        CAPTURE(w);
        CHECK(stretch < 2 * bound);  // of the attitude and the place
        CHECK(w > 0.3);
        const BodyState last_a = world->state(a.link), last_b = world->state(b.link);
        world->remove_constraint(grip);
        REQUIRE_FALSE(world->step());
        const BodyState now_a = world->state(a.link), now_b = world->state(b.link);
        // Each goes on as it moved, unless they overlap and contacts part them.
        if (apart_m < 0.4) continue;
        CHECK(glm::length(now_a.velocity_m_s - last_a.velocity_m_s) < 1e-12);
        CHECK(glm::length(now_b.velocity_m_s - last_b.velocity_m_s) < 1e-12);
        CHECK(glm::length(now_a.center_m - last_a.center_m - kStep_s * last_a.velocity_m_s) < 1e-12);
      }
    }
  }
}

TEST_CASE("what hangs on the world, on a kinematic body and on a static one stays there") {
  const std::string box = body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='0.5 0 1 0 0 0'", "mass='3'");
  const std::string hand =
      "<part name='HAND' insert_at='ROOT' shape='box' size='0.1 0.1 0.1' pose_offset='0 0 1 0 0 0'/>\n";
  const std::string standing = hand + "<element type='body' name='HAND_BODY' insert_at='HAND' kind='static'/>\n",
                    moved = hand + "<element type='pose' name='MOVE' insert_at='HAND'/>\n" +
                            "<element type='body' name='HAND_BODY' insert_at='HAND' kind='kinematic'/>\n";
  const std::string grip = "<element type='attachment' name='GRIP' insert_at='BOX' to='";
  // A torque on a box of 0.02 kg m^2, whose spin of one step the rows take back with the speeds of the step.
  MovedBody on_world(
      kPhysics + box + grip + "ROOT'/>" + "<element type='force' name='TWIST' insert_at='BOX' torque_y='5'/>", "BOX");
  on_world.scene.run(0, 2, 0.1);
  CHECK(glm::length(on_world.motion().center_m - glm::dvec3(0.5, 0, 1)) < kSolved_m_s * kStep_s / kTakenBack);
  CHECK(distance(on_world.motion().world_from_body, glm::translate(glm::dmat4(1), {0.5, 0, 1})) < 1e-9);
  MovedBody on_static(kPhysics + standing + box + grip + "HAND'/>", "BOX");
  on_static.scene.run(0, 2, 0.1);
  CHECK(glm::length(on_static.motion().center_m - glm::dvec3(0.5, 0, 1)) < kSolved_m_s * kStep_s / kTakenBack);
  // The hand turns by 90 degrees and rises, and the box follows on its arc.
  MovedBody carried(kPhysics + moved + box + grip + "HAND'/>", "BOX");
  for (int i = 1; i <= 100; ++i) {
    carried.scene.set("MOVE", "yaw", 0.9 * i);
    carried.scene.set("MOVE", "z", 0.005 * i);
    carried.scene.go_to(0.02 * i);
  }
  carried.scene.run(2, 3, 0.1);
  CHECK(glm::length(carried.motion().center_m - glm::dvec3(0, 0.5, 1.5)) < 1e-6);
  carried.scene.set("GRIP", "attached", 0);
  carried.scene.run(3, 3.2, 0.1);
  // It falls from rest: g (t^2 + t h) / 2.
  CHECK(std::abs(carried.motion().center_m.z - (1.5 - kGravity_m_s2 * (0.04 + 0.2 * kStep_s) / 2)) < 1e-6);
}

TEST_CASE("a body that rests follows what lifts it, and rests on the floor again when it is let go there") {
  const std::string box =
      body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.1 0 0 0'", "mass='1' shape='box'");
  MovingScene lifted(kPhysics + ground() +
                     "<part name='HAND' insert_at='ROOT' shape='box' size='0.1 0.1 0.1' pose_offset='0 0 1 0 0 0'/>"
                     "<element type='pose' name='MOVE' insert_at='HAND'/>"
                     "<element type='body' name='HAND_BODY' insert_at='HAND' kind='kinematic'/>\n" +
                     box + "<element type='attachment' name='GRIP' insert_at='BOX' to='HAND'/>");
  lifted.run(0, 4, 0.1);
  for (int i = 1; i <= 10; ++i) {
    lifted.set("MOVE", "z", 0.05 * i);
    lifted.go_to(4 + 0.1 * i);
  }
  lifted.run(5, 5.5, 0.1);
  CHECK(std::abs(lifted.position("BOX").z - 0.6) < 1e-6);
  MovingScene held(kPhysics + ground() + box + "<element type='attachment' name='GRIP' insert_at='BOX' to='GROUND'/>");
  held.run(0, 1, 0.1);
  held.set("GRIP", "attached", 0);
  held.run(1, 3, 0.1);
  CHECK(std::abs(held.position("BOX").z - 0.1) < 1e-4);
}

// A gantry: a carriage along x carries a palm along z.
const std::string kGantry =
    "<robot name='g'><link name='rail'/><link name='carriage'>" + inertial(5, "0 0 0", 0.1) +
    "</link><link name='palm'>" + inertial(1, "0 0 0", 0.01) +
    "<collision><geometry><box size='0.1 0.1 0.02'/></geometry></collision></link>"
    "<joint name='along' type='prismatic'><parent link='rail'/><child link='carriage'/><axis xyz='1 0 0'/>"
    "<limit lower='-2' upper='2' effort='500' velocity='0.5'/></joint>"
    "<joint name='lift' type='prismatic'><parent link='carriage'/><child link='palm'/><axis xyz='0 0 1'/>"
    "<limit lower='-2' upper='2' effort='500' velocity='0.5'/></joint></robot>";

TEST_CASE("a gripper lifts, carries and releases a box") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "g.urdf") << kGantry;
  MovedBody box(kPhysics + ground() +
                    body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.1 0 0 0'", "mass='2' shape='box'") +
                    "<part name='G' insert_at='ROOT' file='g.urdf' pose_offset='0 0 1 0 0 0'/>\n"
                    "<element type='robot' name='ROBOT' insert_at='G'/>\n"
                    "<element type='attachment' name='GRIP' insert_at='palm' to='BOX' attached='0'/>",
                "BOX", folder.path());
  double now_s = 0;
  const auto go = [&](double along, double lift, double seconds) {
    box.scene.set("ROBOT", "target_along", along);
    box.scene.set("ROBOT", "target_lift", lift);
    box.scene.run(now_s, now_s + seconds, 0.05);
    now_s += seconds;
  };
  const auto palm_from_box = [&] { return glm::inverse(box.scene.pose("palm")) * box.scene.pose("BOX"); };
  // The palm comes down to 1 cm above the box.
  go(0, -0.78, 4);
  const glm::dvec3 rest = box.motion().center_m;
  CHECK(glm::length(rest - glm::dvec3(0, 0, 0.1)) < 1e-3);
  const glm::dmat4 held = palm_from_box();
  box.scene.set("GRIP", "attached", 1);
  box.scene.run(now_s, now_s + 0.05, 0.05);
  now_s += 0.05;
  CHECK(glm::length(box.motion().center_m - rest) < 1e-6);
  double stretch_m = 0;
  for (const auto& [along, lift] : std::vector<std::pair<double, double>>{{0, -0.2}, {1.2, -0.2}, {1.2, -0.77}}) {
    for (int i = 0; i < 40; ++i) {
      go(along, lift, 0.1);
      stretch_m = std::max(stretch_m, distance(palm_from_box(), held));
    }
  }
  // Nothing turns, so only what the passes leave stretches the grip.
  MESSAGE("the grip stretches by at most " << stretch_m << " m");
  CHECK(stretch_m < kSolved_m_s * kStep_s / kTakenBack + 1e-12);
  CHECK(std::abs(box.motion().center_m.x - 1.2) < 1e-3);
  CHECK(std::abs(box.motion().center_m.z - 0.11) < 2e-3);
  box.scene.set("GRIP", "attached", 0);
  go(1.2, -0.2, 3);
  CHECK(glm::length(box.motion().center_m - glm::dvec3(box.motion().center_m.x, 0, 0.1)) < 1e-3);
  CHECK(std::abs(box.motion().center_m.x - 1.2) < 1e-2);
  CHECK(glm::length(box.motion().velocity_m_s) < 1e-3);
}

TEST_CASE("an attachment comes and goes with requests, and with its bodies") {
  Simulation simulation = Simulation::from_string(
      physics("gravity='0 0 0'") + body("A", "shape='box' size='0.2 0.2 0.2'", "mass='1' velocity='1 0 0'") +
      body("B", "shape='box' size='0.2 0.2 0.2' pose_offset='0 1 0 0 0 0'", "mass='1'"));
  const auto step = [&](int frames) {
    for (int i = 0; i < frames; ++i) simulation.step();
  };
  step(3);
  CHECK(simulation.get("B_BODY", "x") == 0);
  // The elements' values move the parts from their places in the file, of which that of B is 1 m along y.
  const auto apart = [&] {
    return std::hypot(simulation.get("B_BODY", "x") - simulation.get("A_BODY", "x"),
                      1 + simulation.get("B_BODY", "y") - simulation.get("A_BODY", "y"));
  };
  const double held_m = apart();
  simulation.execute("<element type='attachment' name='TOW' insert_at='A' to='B'/>");
  // Both turn about their middle, so that B starts slowly: after 10 frames it has gone by more than 1 cm.
  step(10);
  const double towed = simulation.get("B_BODY", "x");
  CHECK(towed > 0.01);
  CHECK(std::abs(apart() - held_m) < 1e-5);
  simulation.execute("<remove name='TOW'/><element type='attachment' name='TOW' insert_at='A' to='B'/>");
  step(1);
  simulation.execute("<remove name='TOW'/>");
  step(10);
  CHECK(apart() > held_m + 0.01);
  simulation.execute("<element type='attachment' name='TOW' insert_at='B' to='A'/><remove name='A_BODY'/>");
  CHECK_NOTHROW(step(3));
  CHECK(simulation.get("B_BODY", "x") > towed);
  simulation.execute("<element type='body' name='A_AGAIN' insert_at='A' mass='1'/>");
  CHECK_NOTHROW(step(3));
  simulation.set("PHYSICS", "restarts", 1);
  CHECK_NOTHROW(step(3));
}

TEST_CASE("a body that is put elsewhere is drawn back slowly, and a restart repeats the motion") {
  MovedBody moved(
      physics("gravity='0 0 0'") + body("A", "shape='box' size='0.2 0.2 0.2'", "mass='1'") +
          body("B", "shape='box' size='0.2 0.2 0.2' pose_offset='0.5 0 0 0 0 0'", "mass='1' velocity='0.4 0 0'") +
          "<element type='attachment' name='GRIP' insert_at='A' to='B'/>",
      "B");
  MovingScene& scene = moved.scene;
  const auto apart = [&] { return scene.position("B").x - scene.position("A").x; };
  scene.run(0, 0.5, 0.1);
  const glm::dvec3 first = moved.motion().center_m;
  CHECK(std::abs(moved.motion().velocity_m_s.x - 0.2) < kSolved_m_s);
  scene.set("B_BODY", "x", 3);
  scene.go_to(0.6);
  CHECK(scene.get("B_BODY", "x") > 2.8);
  scene.run(0.6, 5, 0.1);
  CHECK(std::abs(apart() - 0.5) < 1e-6);
  scene.set("PHYSICS", "restarts", 1);
  scene.go_to(5.1);
  scene.run(5.1, 5.6, 0.1);
  CHECK(moved.motion().center_m == first);
}

TEST_CASE("attachments that cannot be are errors with their place") {
  const std::string boxes = body("A", "shape='box' size='0.2 0.2 0.2'", "mass='1'") +
                            body("B", "shape='box' size='0.2 0.2 0.2' pose_offset='1 0 0 0 0 0'", "mass='1'") +
                            body("WALL", "shape='box' size='1 1 1' pose_offset='5 0 0 0 0 0'", "kind='static'");
  const auto wrong = [&](const std::string& elements) {
    return error_of([&] { MovingScene scene(kPhysics + boxes + "<part name='P' insert_at='ROOT'/>" + elements); });
  };
  const auto attach = [](const std::string& a, const std::string& b, const std::string& name = "E") {
    return "<element type='attachment' name='" + name + "' insert_at='" + a + "' to='" + b + "'/>";
  };
  CHECK(contains(wrong(attach("A", "A")), "\"A\" and \"A\" are one body"));
  CHECK(contains(wrong(attach("A", "NOBODY")), "NOBODY"));
  CHECK(contains(wrong(attach("A", "P")), "no body stands at \"P\""));
  CHECK(contains(wrong(attach("P", "A")), "no body stands at \"P\""));
  CHECK(contains(wrong(attach("WALL", "ROOT")), "no force moves \"WALL\" or \"ROOT\""));
  CHECK(
      contains(wrong(attach("A", "B", "ONE") + attach("B", "A")), "element \"ONE\" attaches \"B\" and \"A\" already"));
  CHECK(contains(wrong("<element type='attachment' name='E' insert_at='A'/>"), "to"));
  CHECK(contains(wrong("<element type='attachment' name='E' insert_at='A' to='B' attached='2'/>"), "attached"));
  CHECK(contains(error_of([&] { MovingScene scene(attach("ROOT", "ROOT")); }), "the scene has no physics"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
