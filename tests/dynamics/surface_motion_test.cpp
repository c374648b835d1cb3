// Surfaces that move while their shapes stay: belts, rollers, and the mecanum, omni and tracked drives made of them.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/mass.h"
#include "exchange/messages/types/geometry_types.h"
#include "tests/support/moved_body.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// What the passes of a step leave of a speed; a frame has several rows that share it.
constexpr double kSolved_m_s = 1e-6;
// The same for what turns: all arms here are at least 0.1 m long.
constexpr double kSolved_rad_s = kSolved_m_s / 0.1;
// Of numbers up to 1000 in some hundred operations, each of which rounds by 2^-53 of them.
constexpr double kRounding = 1e-10;
// A gap or an overlap of what stands: rest_test.cpp has it for each layer.
constexpr double kGap_m = 2e-5;

// Rollers

CollisionShape ball_of(double radius_m) {
  CollisionShape ball{.kind = CollisionKind::sphere, .half_m = glm::dvec3(radius_m)};
  ball.part = 3;
  return ball;
}

TEST_CASE("rollers brake along their axis and let the surface go across it, for bodies and for links") {
  constexpr double kFriction = 0.5, kTime_s = 0.1, kRadius_m = 0.1;
  for (const bool is_link : {false, true}) {
    for (const double angle_deg : {0.0, 30.0, 90.0}) {
      CAPTURE(is_link);
      CAPTURE(angle_deg);
      const auto world =
          dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -kGravity_m_s2}, .step_s = kStep_s, .iterations = 50});
      const SurfaceProperties surface{.friction = kFriction, .restitution = 0, .mask = {}};
      world->add_body({.kind = BodyKind::fixed,
                       .shapes = {{.kind = CollisionKind::plane}},
                       .surface = {.friction = 1, .restitution = 0, .mask = {}}});
      // So much inertia that friction does not turn it: it slides as a block.
      const MassProperties mass{.mass_kg = 2, .center_m = {0, 0, 0}, .inertia_kg_m2 = glm::dmat3(1e9)};
      glm::dmat4 start(1);
      start[3].z = kRadius_m;
      std::size_t id = 0;
      if (is_link) {
        id = world->add_articulation({.fixed_base = false,
                                      .world_from_base = start,
                                      .mass = mass,
                                      .shapes = {ball_of(kRadius_m)},
                                      .surface = surface});
      } else {
        id = world->add_body(
            {.world_from_body = start, .mass = mass, .shapes = {ball_of(kRadius_m)}, .surface = surface});
      }
      const double angle = glm::radians(angle_deg);
      const glm::dvec3 axis(std::cos(angle), std::sin(angle), 0), across(-axis.y, axis.x, 0);
      world->move_surface({id, 3}, {.roller_axis = axis});
      // It comes to its speed by an impulse in the first step, in which it is braked already.
      world->push({id, -1}, {.force_n = 2.0 * (axis + across) / kStep_s});
      for (int i = 0; i < std::lround(kTime_s / kStep_s); ++i) REQUIRE_FALSE(world->step());
      const glm::dvec3 velocity = world->state(id).velocity_m_s;
      CHECK(std::abs(glm::dot(velocity, axis) - (1 - kFriction * kGravity_m_s2 * kTime_s)) < kSolved_m_s);
      CHECK(std::abs(glm::dot(velocity, across) - 1) < kRounding);
    }
  }
}

// Belts

std::string belt(const std::string& attributes, const std::string& kind = "static", double yaw_deg = 0) {
  return kPhysics + body("BELT",
                         "shape='box' size='40 2 0.2' pose_offset='0 0 -0.1 0 0 " + format_number(yaw_deg) + "'",
                         "kind='" + kind + "' friction='0.8' " + attributes);
}
const std::string kCarton =
    body("CARTON", "shape='box' size='0.4 0.3 0.2' pose_offset='0 0 0.1 0 0 0'", "shape='box' mass='3' friction='0.5'");

TEST_CASE("a belt accelerates a box by friction up to its own speed, whatever its shape, kind and heading") {
  constexpr double kSpeed_m_s = 1.2, kAcceleration = 0.4 * kGravity_m_s2;
  int tried = 0;
  for (const char* const shape : {"box", "hull", "mesh"}) {
    for (const char* const kind : {"static", "kinematic"}) {
      if (std::string(shape) == "mesh" && std::string(kind) == "kinematic") continue;
      for (const double yaw_deg : {0.0, 30.0}) {
        CAPTURE(shape);
        CAPTURE(kind);
        CAPTURE(yaw_deg);
        MovedBody box(belt("shape='" + std::string(shape) + "' belt='1 0 0' belt_speed='1.2'", kind, yaw_deg) + kCarton,
                      "CARTON");
        const glm::dvec3 along(std::cos(glm::radians(yaw_deg)), std::sin(glm::radians(yaw_deg)), 0);
        box.scene.run(0, 0.2, 0.1);
        CHECK(glm::length(box.motion().velocity_m_s - 0.2 * kAcceleration * along) < kSolved_m_s);
        box.scene.run(0.2, 2, 0.1);
        CHECK(glm::length(box.motion().velocity_m_s - kSpeed_m_s * along) < kSolved_m_s);
        // It slips until v / a. The way is that of semi-implicit steps, half a step longer while it slips.
        const double slips_s = kSpeed_m_s / kAcceleration, way = kSpeed_m_s * (2 - slips_s / 2);
        CHECK(std::abs(glm::dot(box.motion().center_m, along) - way) < kSpeed_m_s * kStep_s);
        CHECK(std::abs(box.motion().center_m.z - 0.1) < kGap_m);
        ++tried;
      }
    }
  }
  CHECK(tried == 10);
}

TEST_CASE("a ball on a belt rolls at two sevenths of its speed") {
  MovedBody ball(belt("shape='box' belt='0 2 0' belt_speed='0.7'") +
                     body("BALL", "shape='sphere' radius='0.1' pose_offset='0 0 0.1 0 0 0'",
                          "shape='sphere' mass='1' friction='0.5'"),
                 "BALL");
  ball.scene.run(0, 0.5, 0.1);
  // Friction J m / s speeds the ball up and turns its lower side by 5/2 of that, until it moves with the belt.
  CHECK(glm::length(ball.motion().velocity_m_s - glm::dvec3(0, 0.2, 0)) < kSolved_m_s);
  CHECK(glm::length(ball.motion().angular_velocity_rad_s - glm::dvec3(5, 0, 0)) < kSolved_rad_s);
}

// A box of 2 m whose upper side is z = 0, and one of 0.2 m on it.
BodyDesc table_at(double x) {
  BodyDesc table{.kind = BodyKind::fixed, .shapes = {{.kind = CollisionKind::box, .half_m = {1, 1, 1}, .part = 3}}};
  table.world_from_body[3] = {x, 0, -1, 1};
  return table;
}
BodyDesc carton_at(double x) {
  BodyDesc carton{.mass = {.mass_kg = 1, .center_m = {0, 0, 0}, .inertia_kg_m2 = glm::dmat3(0.04 / 6)},
                  .shapes = {{.kind = CollisionKind::box, .half_m = glm::dvec3(0.1)}}};
  carton.world_from_body[3] = {x, 0, 0.1, 1};
  return carton;
}
std::unique_ptr<DynamicsWorld> world_with_weight() {
  return dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -kGravity_m_s2}, .step_s = kStep_s, .iterations = 50});
}
void run(DynamicsWorld& world, double time_s) {
  for (int i = 0; i < std::lround(time_s / kStep_s); ++i) REQUIRE_FALSE(world.step());
}
constexpr double kFallsAsleep_s = 3;

TEST_CASE("a surface that starts wakes what lies on it, and nothing else") {
  const auto world = world_with_weight();
  const std::size_t belt = world->add_body(table_at(0));
  world->add_body(table_at(10));
  const std::size_t carried = world->add_body(carton_at(0)), other = world->add_body(carton_at(10));
  run(*world, kFallsAsleep_s);
  REQUIRE(world->awake() == 0);
  world->move_surface({belt, 3}, {.belt_m_s = {0, 0.5, 0}});
  CHECK(world->awake() == 1);
  run(*world, 1);
  CHECK(glm::length(world->state(carried).velocity_m_s - glm::dvec3(0.5, 0, 0)) < kSolved_m_s);
  CHECK(world->awake() == 1);
  CHECK(world->state(other).velocity_m_s == glm::dvec3(0));
  glm::dmat4 above(1);
  above[3].z = 5;
  const std::size_t links = world->add_articulation({.fixed_base = false,
                                                     .world_from_base = above,
                                                     .mass = {.mass_kg = 1, .inertia_kg_m2 = glm::dmat3(1)},
                                                     .shapes = {ball_of(0.1)}});
  REQUIRE(world->awake() == 2);
  world->move_surface({links, 3}, {.belt_m_s = {0, 0.5, 0}});
  CHECK(world->awake() == 2);
}

TEST_CASE("a belt below the speed of what rests carries on") {
  constexpr double kSpeed_m_s = kRestSpeed_m_s / 2, kTime_s = 10;
  const auto world = world_with_weight();
  const std::size_t belt = world->add_body(table_at(0)), carton = world->add_body(carton_at(0));
  world->move_surface({belt, 3}, {.belt_m_s = {0, kSpeed_m_s, 0}});
  run(*world, kTime_s);
  CHECK(world->awake() == 1);
  // The box comes to the speed of the belt within a step, since friction may give it g dt x friction.
  CHECK(std::abs(world->state(carton).center_m.x - kTime_s * kSpeed_m_s) < kSpeed_m_s * kStep_s + kTime_s * 1e-8);
}

TEST_CASE("a belt that starts wakes what sleeps on it, stops it again, and restarts from its start") {
  MovedBody box(belt("shape='box' belt='-1 0 0'") + kCarton, "CARTON");
  box.scene.run(0, 4, 0.5);
  CHECK(std::abs(box.scene.position("CARTON").x) < 4 * kSolved_m_s);
  box.scene.set("BELT_BODY", "belt_speed", 0.5);
  box.scene.run(4, 5, 0.5);
  CHECK(glm::length(box.motion().velocity_m_s - glm::dvec3(-0.5, 0, 0)) < kSolved_m_s);
  box.scene.set("BELT_BODY", "belt_speed", 0);
  box.scene.run(5, 6, 0.5);
  CHECK(glm::length(box.motion().velocity_m_s) < kSolved_m_s);
  box.scene.set("PHYSICS", "restarts", 1);
  box.scene.set("BELT_BODY", "belt_speed", 0.5);
  box.scene.go_to(6.5);
  box.scene.go_to(7.5);
  CHECK(glm::length(box.motion().velocity_m_s - glm::dvec3(-0.5, 0, 0)) < kSolved_m_s);
}

TEST_CASE("a belt carries the base of a robot too") {
  MovedBody sled(belt("shape='box' belt='1 0 0' belt_speed='0.8'") +
                     "<part name='SLED' insert_at='ROOT' shape='box' size='0.4 0.3 0.2' pose_offset='0 0 0 0 0 0'/>"
                     "<element type='vehicle' drive='tracked' name='DRIVE' insert_at='SLED' mass='5' wheelbase='0.4' "
                     "axle='-0.2' clearance='0.05' wheel_friction='0.5'/>",
                 "SLED");
  sled.scene.run(0, 2, 0.1);
  CHECK(glm::length(sled.motion().velocity_m_s - glm::dvec3(0.8, 0, 0)) < kSolved_m_s);
}

TEST_CASE("a direction of any length is one") {
  for (const char* const direction : {"1e300 0 0", "1e-170 0 0", "3 0 0"}) {
    CAPTURE(direction);
    MovedBody box(belt("shape='box' belt_speed='0.5' belt='" + std::string(direction) + "'") + kCarton, "CARTON");
    box.scene.run(0, 1, 0.5);
    CHECK(glm::length(box.motion().velocity_m_s - glm::dvec3(0.5, 0, 0)) < kSolved_m_s);
  }
}

TEST_CASE("mistakes of belts are errors with their place") {
  const auto wrong = [](const std::string& attributes) {
    return error_of([&] { MovingScene scene(belt(attributes)); });
  };
  CHECK(contains(wrong("belt_speed='1'"), "\"belt_speed\" is allowed only with the direction \"belt\""));
  CHECK(contains(wrong("belt='0 0 1'"), "expected a direction across z"));
  CHECK(contains(wrong("belt='0 0 0'"), "\"belt\" has no direction"));
  MovingScene plain(belt(""));
  CHECK(contains(error_of([&] { plain.set("BELT_BODY", "belt_speed", 1); }), "belt_speed"));
}

// Drives

constexpr double kRadius_m = 0.1, kFriction = 0.5;

std::string car(const std::string& drive, double yaw_deg = 0, const std::string& place = "") {
  const std::string tilt = place.empty() ? "0 0 0 0 0 " + format_number(yaw_deg) : place;
  return "<part name='CAR' insert_at='ROOT' shape='box' size='0.6 0.3 0.2' pose_offset='" + tilt +
         "'/>\n<element type='vehicle' name='DRIVE' insert_at='CAR' mass='10' clearance='0.05' center='0 0 0.1' " +
         drive + "/>\n";
}
std::string floor_and(const std::string& vehicle) { return kPhysics + ground("friction='0.5'") + vehicle; }

struct Wheel {
  const char* parameter;
  double forward, left, turn;  // its speed in m/s per forward and left in m/s and turn in rad/s, without slip
};
// Corners at x = +-0.25, y = +-0.2: forward -+ left -+ (0.25 + 0.2) turn.
constexpr std::array<Wheel, 4> kMecanum = {Wheel{"front_left", 1, -1, -0.45},
                                           {"front_right", 1, 1, 0.45},
                                           {"rear_left", 1, 1, -0.45},
                                           {"rear_right", 1, -1, 0.45}};
// At 60, 180 and 300 degrees on a circle of 0.25: -sin a forward + cos a left + 0.25 turn.
const double kSin60 = std::sqrt(3.0) / 2;
const std::array<Wheel, 3> kOmni = {
    Wheel{"wheel_1", -kSin60, 0.5, 0.25}, {"wheel_2", 0, -1, 0.25}, {"wheel_3", kSin60, 0.5, 0.25}};
const std::string kMecanumDrive = "drive='mecanum' axle='-0.25' wheelbase='0.5' track='0.4'",
                  kOmniDrive = "drive='omni' track='0.5'";

TEST_CASE("wheels with rollers whose speeds fit move the vehicle without slip, in each direction and heading") {
  struct Motion {
    double forward, left, turn;
  };
  const auto check = [](const std::string& drive, const auto& wheels, const Motion& motion, double yaw_deg) {
    CAPTURE(drive);
    CAPTURE(motion.forward);
    CAPTURE(motion.left);
    CAPTURE(motion.turn);
    MovedBody moved(floor_and(car(drive, yaw_deg)), "CAR");
    for (const Wheel& wheel : wheels) {
      const double speed = wheel.forward * motion.forward + wheel.left * motion.left + wheel.turn * motion.turn;
      moved.scene.set("DRIVE", wheel.parameter, glm::degrees(speed / kRadius_m));
    }
    moved.scene.run(0, 1, 0.1);
    const glm::dmat3 turn(moved.scene.pose("CAR"));
    const glm::dvec3 velocity = glm::transpose(turn) * moved.motion().velocity_m_s;
    // Friction makes the speed at the end of a step right for the heading at its beginning.
    const double turned_m_s = std::abs(motion.turn) * kStep_s * std::hypot(motion.forward, motion.left);
    CHECK(std::abs(velocity.x - motion.forward) < kSolved_m_s + turned_m_s);
    CHECK(std::abs(velocity.y - motion.left) < kSolved_m_s + turned_m_s);
    CHECK(std::abs(moved.motion().angular_velocity_rad_s.z - motion.turn) < kSolved_rad_s + turned_m_s);
    CHECK(std::abs(moved.scene.position("CAR").z) < kGap_m);
  };
  int tried = 0;
  for (const Motion& motion :
       {Motion{0.5, 0, 0}, Motion{0, 0.4, 0}, Motion{0, 0, 1}, Motion{-0.3, 0.4, 0}, Motion{0.3, -0.2, 0.7}}) {
    for (const double yaw_deg : {0.0, 125.0}) {
      check(kMecanumDrive, kMecanum, motion, yaw_deg);
      check(kOmniDrive, kOmni, motion, yaw_deg);
      ++tried;
    }
  }
  CHECK(tried == 10);
}

TEST_CASE("a Twist with a sideways speed sets the wheels of mecanum and omni drives") {
  const auto check = [](const std::string& drive, const auto& wheels) {
    MovingScene scene(floor_and(car(drive)) +
                      "<element type='velocity_command' name='COMMAND' insert_at='CAR' vehicle='DRIVE' topic='/cmd'/>");
    scene.command({"/cmd", &ros::describe<ros::Twist>()}, ros::encode(ros::Twist{{0.3, -0.2, 0}, {0, 0, 0.7}}));
    scene.go_to(0.1);
    for (const Wheel& wheel : wheels) {
      const double speed = 0.3 * wheel.forward - 0.2 * wheel.left + 0.7 * wheel.turn;
      CHECK(std::abs(glm::radians(scene.get("DRIVE", wheel.parameter)) * kRadius_m - speed) < kRounding);
    }
    // Beyond the largest speed of a wheel all are slowed down together.
    scene.command({"/cmd", &ros::describe<ros::Twist>()}, ros::encode(ros::Twist{{900, 0, 0}, {0, 0, 100}}));
    scene.go_to(0.2);
    const double first = 900 * wheels[0].forward + 100 * wheels[0].turn,
                 last = 900 * wheels.back().forward + 100 * wheels.back().turn;
    CHECK(
        std::abs(scene.get("DRIVE", wheels[0].parameter) * last - scene.get("DRIVE", wheels.back().parameter) * first) <
        kRounding * std::abs(first * scene.get("DRIVE", wheels.back().parameter)));
    scene.go_to(0.7);
    scene.go_to(0.8);  // the command has ended
    for (const Wheel& wheel : wheels) CHECK(scene.get("DRIVE", wheel.parameter) == 0);
  };
  check(kMecanumDrive, kMecanum);
  check(kOmniDrive, kOmni);
}

TEST_CASE("a mecanum drive strafes with at most the friction along its rollers") {
  MovedBody moved(floor_and(car(kMecanumDrive)), "CAR");
  for (const Wheel& wheel : kMecanum) moved.scene.set("DRIVE", wheel.parameter, 1e5 * wheel.left);
  // The friction of each wheel acts along its rollers, at 45 degrees to the way. How four wheels share the weight is
  // not determined, so there may be a speed along x, and soon a turn.
  constexpr double kTime_s = 0.02;
  moved.scene.run(0, kTime_s, kTime_s);
  const double expected = kFriction * kGravity_m_s2 * kTime_s / std::numbers::sqrt2;
  CHECK(std::abs(moved.motion().velocity_m_s.y - expected) < static_cast<double>(kMecanum.size()) * kSolved_m_s);
}

const std::string kTracked =
    "drive='tracked' axle='-0.25' wheelbase='0.5' track='0.4' track_width='0.01' wheel_radius='0.1'";

TEST_CASE("tracks drive straight at their speed") {
  MovedBody moved(floor_and(car(kTracked + " left='200' right='200'", 40)), "CAR");
  moved.scene.run(0, 1, 0.1);
  const double speed = glm::radians(200.0) * kRadius_m, yaw = glm::radians(40.0);
  CHECK(glm::length(moved.motion().velocity_m_s - speed * glm::dvec3(std::cos(yaw), std::sin(yaw), 0)) < kSolved_m_s);
}

TEST_CASE("tracks turn on the spot while they skid, by the balance of their friction") {
  MovedBody moved(floor_and(car(kTracked + " left='-150' right='150'")), "CAR");
  moved.scene.run(0, 2, 0.1);
  // Each track touches the floor at its corners (x, y). One that moves at s along x slides at (s - w y, w x), and its
  // friction against that has no moment if (s - w y) y = w x^2: w = s y / (x^2 + y^2). Inner and outer corners share
  // the load in a way that is not known, so w lies between their values.
  const double speed = glm::radians(150.0) * kRadius_m, x = 0.25;
  const auto rate = [&](double y) { return speed * y / (x * x + y * y); };
  const double turn = moved.motion().angular_velocity_rad_s.z;
  CHECK(turn > rate(0.195) - kSolved_rad_s);
  CHECK(turn < rate(0.205) + kSolved_rad_s);
}

TEST_CASE("tracks climb up to the slope of their friction, and slide down a steeper one") {
  for (const double steeper_deg : {-2.0, 2.0}) {
    CAPTURE(steeper_deg);
    const double slope_deg = glm::degrees(std::atan(kFriction)) + steeper_deg, slope = glm::radians(slope_deg);
    // The slope rises along +x; a negative pitch raises the front.
    const std::string tilt = format_number(-slope_deg);
    MovedBody moved(kPhysics +
                        body("HILL",
                             "shape='box' size='100 100 2' pose_offset='" + format_number(std::sin(slope)) + " 0 " +
                                 format_number(-std::cos(slope)) + " 0 " + tilt + " 0'",
                             "kind='static' shape='box' friction='0.5'") +
                        car(kTracked + " left='100' right='100'", 0, "0 0 0 0 " + tilt + " 0"),
                    "CAR");
    moved.scene.run(0, 1, 0.1);
    const glm::dvec3 uphill(std::cos(slope), 0, std::sin(slope));
    const double sliding = kGravity_m_s2 * (kFriction * std::cos(slope) - std::sin(slope)) * 1,
                 expected = steeper_deg < 0 ? glm::radians(100.0) * kRadius_m : sliding;
    CHECK(std::abs(glm::dot(moved.motion().velocity_m_s, uphill) - expected) < kSolved_m_s);
  }
}

TEST_CASE("each drive has its own parameters and attributes") {
  const auto wrong = [](const std::string& drive) {
    return error_of([&] { MovingScene scene(floor_and(car(drive))); });
  };
  CHECK(contains(wrong("drive='mecanum' left='1'"), "\"left\" is allowed only for a differential drive and tracks"));
  CHECK(contains(wrong("drive='omni' front_left='1'"), "\"front_left\" is allowed only for a mecanum drive"));
  CHECK(contains(wrong("drive='tracked' wheel_1='1'"), "\"wheel_1\" is allowed only for an omni drive"));
  CHECK(contains(wrong("drive='tracked' max_torque='1'"), "\"max_torque\" is allowed only for"));
  CHECK(contains(wrong("drive='omni' wheelbase='1'"), "\"wheelbase\" is allowed only for"));
  CHECK(contains(wrong("track_width='1'"), "\"track_width\" is allowed only for a tracked drive"));
  CHECK(contains(wrong("drive='hover'"), "drive"));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
