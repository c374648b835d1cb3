// Bodies and links of robots that move by far more than their size within a step, against thin walls.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>
#include <string>
#include <vector>

#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/world.h"
#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kFastHalf_m = 0.02, kFastMass_kg = 0.1;  // the half size of what moves, along x

CollisionShape fast_hull(const glm::dvec3& half, const glm::dvec3& at = glm::dvec3(0)) {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 8; ++i) {
    points.push_back(at + half * glm::dvec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1));
  }
  return dynamics_engine().convex_hull(points).value();
}

struct FastShape {
  std::string name;
  std::vector<CollisionShape> shapes;
};

std::vector<FastShape> fast_shapes() {
  CollisionShape capsule{.kind = CollisionKind::capsule, .half_m = {kFastHalf_m, kFastHalf_m, 0.03}};
  CollisionShape cylinder{.kind = CollisionKind::cylinder, .half_m = {kFastHalf_m, kFastHalf_m, 0.03}};
  const glm::dvec3 half(kFastHalf_m / 2, 0.03, 0.03);
  return {{"ball", {{.kind = CollisionKind::sphere, .half_m = glm::dvec3(kFastHalf_m)}}},
          {"box", {{.kind = CollisionKind::box, .half_m = glm::dvec3(kFastHalf_m)}}},
          {"capsule", {capsule}},
          {"cylinder", {cylinder}},
          {"hull", {fast_hull(glm::dvec3(kFastHalf_m))}},
          {"pieces", {fast_hull(half, {half.x, 0, 0}), fast_hull(half, {-half.x, 0, 0})}}};
}

// A wall whose face towards -x is x = 0.
struct FastWall {
  std::string name;
  CollisionShape shape;
};

// Sheets at x = 0 and at `thick_m`; one if it is 0.
CollisionShape wall_mesh(double thick_m) {
  constexpr std::uint32_t kCells = 6;
  constexpr double kHalfWall_m = 2;
  CollisionShape mesh{.kind = CollisionKind::mesh};
  for (const double x : thick_m > 0 ? std::vector{0.0, thick_m} : std::vector{0.0}) {
    const auto first = static_cast<std::uint32_t>(mesh.points.size());
    for (std::uint32_t i = 0; i < (kCells + 1) * (kCells + 1); ++i) {
      const std::uint32_t column = i % (kCells + 1), row = i / (kCells + 1);
      mesh.points.emplace_back(x, kHalfWall_m * (2.0 * column / kCells - 1), kHalfWall_m * (2.0 * row / kCells - 1));
    }
    for (std::uint32_t i = 0; i < kCells * kCells; ++i) {
      const std::uint32_t a = first + i / kCells * (kCells + 1) + i % kCells, b = a + 1, c = a + kCells + 1, d = c + 1;
      mesh.triangles.insert(mesh.triangles.end(), {a, b, d, a, d, c});
    }
  }
  return mesh;
}

std::vector<FastWall> fast_walls() {
  constexpr double kThick_m = 0.02;
  CollisionShape box{.kind = CollisionKind::box, .half_m = {kThick_m / 2, 2, 2}};
  box.body_from_shape = glm::translate(glm::dmat4(1), {kThick_m / 2, 0, 0});
  CollisionShape plane{.kind = CollisionKind::plane};
  plane.body_from_shape = glm::rotate(glm::dmat4(1), -glm::half_pi<double>(), {0, 1, 0});
  return {{"box", box},
          {"hull", fast_hull({kThick_m / 2, 2, 2}, {kThick_m / 2, 0, 0})},
          {"mesh", wall_mesh(kThick_m)},
          {"heightmap", wall_mesh(0)},
          {"plane", plane}};
}

// What carries the shape: a body, the base of a robot, a link on a slide, a link on an arm of 1 m.
enum class FastCarrier { body, base, slide, arm };
constexpr double kArm_m = 1;
const MassProperties kFastMass{.mass_kg = kFastMass_kg,
                               .inertia_kg_m2 = glm::dmat3(kFastMass_kg * 4 * kFastHalf_m * kFastHalf_m / 6)};

// The arm turns about z at `at` + 1 m along y, and is at `at` at the angle 0.
ArticulationDesc fast_robot(const FastShape& shape, FastCarrier carrier, const glm::dvec3& at, double angle) {
  const glm::dmat4 pose = glm::translate(glm::dmat4(1), at);
  ArticulationDesc robot{.fixed_base = carrier != FastCarrier::base, .world_from_base = pose, .mass = kFastMass};
  if (carrier == FastCarrier::base) {
    robot.shapes = shape.shapes;
    return robot;
  }
  LinkDesc link{.joint = JointKind::prismatic, .axis = {1, 0, 0}, .mass = kFastMass, .shapes = shape.shapes};
  if (carrier == FastCarrier::arm) {
    link.joint = JointKind::revolute;
    link.axis = {0, 0, 1};
    link.parent_from_joint = glm::translate(glm::dmat4(1), {0, kArm_m, 0});
    link.position = angle;
    link.mass.center_m = {0, -kArm_m, 0};
    for (CollisionShape& each : link.shapes) {
      each.body_from_shape = glm::translate(glm::dmat4(1), {0, -kArm_m, 0}) * each.body_from_shape;
    }
  }
  robot.links = {link};
  return robot;
}

// Adds what flies from `at` along x. On an arm it turns from `angle` on.
WorldLink add_fast(DynamicsWorld& world, const FastShape& shape, FastCarrier carrier, const glm::dvec3& at,
                   double speed_m_s, double angle = 0) {
  if (carrier == FastCarrier::body) {
    return {.id = world.add_body({.world_from_body = glm::translate(glm::dmat4(1), at),
                                  .mass = kFastMass,
                                  .shapes = shape.shapes,
                                  .velocity_m_s = {speed_m_s, 0, 0}})};
  }
  const WorldLink link{.id = world.add_articulation(fast_robot(shape, carrier, at, angle)),
                       .link = carrier == FastCarrier::base ? -1 : 0};
  // A push of one step gives the speed.
  const double force_n = kFastMass_kg * speed_m_s / kStep_s;
  world.push(link, {.force_n = force_n * glm::dvec3(std::cos(angle), std::sin(angle), 0)});
  return link;
}

std::unique_ptr<DynamicsWorld> fast_world() {
  return dynamics_engine().make_world({.step_s = kStep_s, .iterations = 50});
}

TEST_CASE("fast bodies and links stop at thin walls, whatever their shapes") {
  // What is left of a corner that turns by 0.3 rad in the step of the hit, of which the solver knows the tangent only.
  constexpr double kDeep_m = 1e-4;
  int trials = 0;
  for (const FastCarrier carrier : {FastCarrier::body, FastCarrier::base, FastCarrier::slide, FastCarrier::arm}) {
    for (const FastWall& wall : fast_walls()) {
      for (const FastShape& shape : fast_shapes()) {
        for (const double speed_m_s : {5.0, 50.0, 300.0}) {
          CAPTURE(static_cast<int>(carrier));
          CAPTURE(wall.name);
          CAPTURE(shape.name);
          CAPTURE(speed_m_s);
          const auto world = fast_world();
          world->add_body({.kind = BodyKind::fixed, .shapes = {wall.shape}});
          const bool turns = carrier == FastCarrier::arm;
          const double way_m = turns ? 0 : 3 * speed_m_s * kStep_s + 0.0137;
          constexpr double kSwing_rad = 0.35;
          const WorldLink link = add_fast(*world, shape, carrier, {-kFastHalf_m - way_m, 0.013, 0.007}, speed_m_s,
                                          turns ? -kSwing_rad : 0);
          REQUIRE_FALSE(world->step());
          double front_m = -1;
          const int steps = 10 + static_cast<int>(turns ? kSwing_rad * kArm_m / (speed_m_s * kStep_s) : 0);
          for (int i = 0; i < steps; ++i) {
            REQUIRE_FALSE(world->step());
            front_m = std::max(front_m, world->state(link).center_m.x + kFastHalf_m);
          }
          CHECK(std::abs(front_m) < kDeep_m);
          CHECK(std::abs(world->state(link).center_m.x + kFastHalf_m) < kDeep_m);
          ++trials;
        }
      }
    }
  }
  CHECK(trials == 4 * 5 * 6 * 3);
}

TEST_CASE("fast bodies and links stop each other") {
  for (const FastCarrier left : {FastCarrier::body, FastCarrier::base, FastCarrier::slide}) {
    for (const FastCarrier right : {FastCarrier::body, FastCarrier::base, FastCarrier::slide}) {
      for (const FastShape& shape : fast_shapes()) {
        for (const double speed_m_s : {50.0, 300.0}) {
          CAPTURE(static_cast<int>(left));
          CAPTURE(static_cast<int>(right));
          CAPTURE(shape.name);
          CAPTURE(speed_m_s);
          const auto world = fast_world();
          const double away_m = kFastHalf_m + 2.3 * speed_m_s * kStep_s;
          const WorldLink a = add_fast(*world, shape, left, {-away_m, 0, 0}, speed_m_s);
          const WorldLink b = add_fast(*world, shape, right, {away_m, 0, 0}, -speed_m_s);
          REQUIRE_FALSE(world->step());
          for (int i = 0; i < 6; ++i) REQUIRE_FALSE(world->step());
          // A robot's link meets a body a step after it was thrown, so they do not meet in the middle.
          CHECK(std::abs(world->state(b).center_m.x - world->state(a).center_m.x - 2 * kFastHalf_m) < 1e-4);
        }
      }
    }
  }
}

TEST_CASE("a fast link passes by the edge of a wall that it does not hit") {
  for (const FastCarrier carrier : {FastCarrier::body, FastCarrier::base, FastCarrier::slide}) {
    for (const double speed_m_s : {50.0, 300.0}) {
      CAPTURE(static_cast<int>(carrier));
      CAPTURE(speed_m_s);
      const auto world = fast_world();
      world->add_body({.kind = BodyKind::fixed, .shapes = {fast_walls()[0].shape}});
      constexpr double kPast_m = 2.025;  // the wall ends at 2 m, the ball 5 mm above
      const WorldLink link =
          add_fast(*world, fast_shapes()[0], carrier, {-2.5 * speed_m_s * kStep_s, kPast_m, 0}, speed_m_s);
      REQUIRE_FALSE(world->step());
      for (int i = 0; i < 4; ++i) REQUIRE_FALSE(world->step());
      const BodyState past = world->state(link);
      CHECK(std::abs(past.center_m.x - 2.5 * speed_m_s * kStep_s) < 1e-9);
      CHECK(std::abs(past.center_m.y - kPast_m) < 1e-12);
    }
  }
}

TEST_CASE("a rod that turns fast does not come through a wall") {
  constexpr double kHalfRod_m = 0.5, kRodMoment_kg_m2 = 1.0 / 12;
  for (const FastWall& wall : fast_walls()) {
    for (const double turn_rad_s : {10.0, 100.0, 300.0}) {
      for (const double speed_m_s : {0.0, 50.0}) {
        CAPTURE(wall.name);
        CAPTURE(turn_rad_s);
        CAPTURE(speed_m_s);
        const auto world = fast_world();
        world->add_body({.kind = BodyKind::fixed, .shapes = {wall.shape}});
        const CollisionShape rod{.kind = CollisionKind::box, .half_m = {0.02, kHalfRod_m, 0.02}};
        const glm::dvec3 at{-0.3 - 0.012 * speed_m_s, 0.013, 0.007};
        const std::size_t id = world->add_body({.world_from_body = glm::translate(glm::dmat4(1), at),
                                                .mass = {.mass_kg = 1, .inertia_kg_m2 = glm::dmat3(kRodMoment_kg_m2)},
                                                .shapes = {rod},
                                                .velocity_m_s = {speed_m_s, 0, 0},
                                                .angular_velocity_rad_s = {0, 0, turn_rad_s}});
        double deepest_m = -1;
        for (int i = 0; i < 200; ++i) {
          REQUIRE_FALSE(world->step());
          for (const double end : {-kHalfRod_m, kHalfRod_m}) {
            deepest_m = std::max(deepest_m, (world->state(id).world_from_body * glm::dvec4(0, end, 0, 1)).x);
          }
        }
        CHECK(deepest_m < 0);      // its axis; the rod is 2 cm thicker
        CHECK(deepest_m > -0.03);  // and reached the wall
      }
    }
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
