// Bodies that rest cost nothing until something touches them, and what does not rest goes on.
#include <doctest/doctest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/world.h"
#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr int kSecond = static_cast<int>(1 / kStep_s);

std::unique_ptr<DynamicsWorld> world_of(double gravity_m_s2) {
  return dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -gravity_m_s2}, .step_s = kStep_s, .iterations = 50});
}

glm::dmat4 at(double x, double z) {
  glm::dmat4 pose(1);
  pose[3] = {x, 0, z, 1};
  return pose;
}

BodyDesc cube(double x, double z) {
  BodyDesc desc{.world_from_body = at(x, z)};
  desc.shapes = {{.kind = CollisionKind::box, .half_m = glm::dvec3(0.1)}};
  desc.mass = {.mass_kg = 1, .center_m = {0, 0, 0}, .inertia_kg_m2 = glm::dmat3(0.04 / 6)};
  return desc;
}

void add_floor(DynamicsWorld& world) {
  BodyDesc floor{.kind = BodyKind::fixed, .world_from_body = at(0, -1)};
  floor.shapes = {{.kind = CollisionKind::box, .half_m = {50, 50, 1}}};
  world.add_body(floor);
}

void run(DynamicsWorld& world, int steps) {
  for (int i = 0; i < steps; ++i) REQUIRE_FALSE(world.step());
}

// A stack trembles now and then, and rests 2 s after the last time.
void run_until_rest(DynamicsWorld& world) {
  constexpr int kMost = 30 * kSecond;
  for (int i = 0; i < kMost && world.awake() > 0; ++i) REQUIRE_FALSE(world.step());
  CHECK(world.awake() == 0);
}

glm::dvec3 place_of(const DynamicsWorld& world, std::size_t id) {
  return glm::dvec3(world.state(id).world_from_body[3]);
}

TEST_CASE("a stack that stands costs nothing, and moves again when a body falls on it") {
  const auto world = world_of(kGravity_m_s2);
  add_floor(*world);
  std::vector<std::size_t> stack;
  for (int i = 0; i < 3; ++i) stack.push_back(world->add_body(cube(0, 0.1 + 0.2 * i)));
  const std::size_t other = world->add_body(cube(5, 0.1));
  CHECK(world->awake() == 4);
  run_until_rest(*world);
  const glm::dmat4 before = world->state(stack[2]).world_from_body;
  run(*world, kSecond);
  CHECK(world->state(stack[2]).world_from_body == before);
  CHECK(world->state(stack[2]).velocity_m_s == glm::dvec3(0));
  CHECK(world->contacts().size() >= 3);  // contacts are there as before
  const std::size_t falling = world->add_body(cube(0, 1.5));
  CHECK(world->awake() == 1);
  run(*world, kSecond / 2);  // it has fallen 0.8 m by 0.4 s
  CHECK(world->awake() == 4);
  CHECK(world->state(other).velocity_m_s == glm::dvec3(0));
  run_until_rest(*world);
  CHECK(std::abs(place_of(*world, falling).z - 0.7) < 1e-3);
}

TEST_CASE("what is taken from below, or moved, wakes what rests on it") {
  const auto world = world_of(kGravity_m_s2);
  add_floor(*world);
  const std::size_t lower = world->add_body(cube(0, 0.1)), upper = world->add_body(cube(0, 0.3));
  run_until_rest(*world);
  world->move(lower, at(3, 0.1));
  run(*world, kSecond);
  CHECK(std::abs(place_of(*world, upper).z - 0.1) < 1e-3);
  world->move(upper, at(3, 0.3));
  run_until_rest(*world);
  world->remove(lower);
  run(*world, kSecond);
  CHECK(std::abs(place_of(*world, upper).z - 0.1) < 1e-3);
}

// Layers of 2 x 2 boxes, each shifted so that a box stands on up to four others: more contacts than the passes of one
// step can solve, so the impulses must stay from step to step.
TEST_CASE("a heap of bricks that has fallen comes to rest, at steps of any length") {
  constexpr double kFalls_s = 0.5, kTrembles_s = 3, kSleeps_s = 2;
  for (const double step_s : {2.5e-4, 1e-3, 4e-3}) {
    CAPTURE(step_s);
    const auto world =
        dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -kGravity_m_s2}, .step_s = step_s, .iterations = 50});
    add_floor(*world);
    std::vector<std::size_t> bricks;
    for (int layer = 0; layer < 8; ++layer) {
      for (const auto& [x, y] : {std::pair{0, 0}, {0, 1}, {1, 0}, {1, 1}}) {
        BodyDesc brick = cube(0.22 * x + 0.03 * (layer % 3), 0.3 + 0.22 * layer);
        brick.world_from_body[3].y = 0.22 * y + 0.02 * (layer % 2);
        bricks.push_back(world->add_body(brick));
      }
    }
    run(*world, static_cast<int>((kFalls_s + kTrembles_s + kSleeps_s) / step_s));
    CHECK(world->awake() == 0);
    constexpr double kGap_m = 2e-5;  // counts as closed
    for (std::size_t i = 0; i < bricks.size(); ++i) {
      const double layer = static_cast<double>(i / 4), flat = 0.1 + 0.2 * layer;
      CHECK(std::abs(place_of(*world, bricks[i]).z - flat) < (layer + 1) * kGap_m);
    }
  }
}

TEST_CASE("a body falls on a floor that was put elsewhere, and sleeps on it") {
  const auto world = world_of(kGravity_m_s2);
  BodyDesc floor{.kind = BodyKind::fixed, .world_from_body = at(50, 0)};
  floor.shapes = {{.kind = CollisionKind::box, .half_m = {1, 1, 1}}};
  const std::size_t moved = world->add_body(floor), falling = world->add_body(cube(0, 2));
  run(*world, kSecond / 10);
  world->move(moved, at(0, -1));
  run(*world, kSecond);
  CHECK(std::abs(place_of(*world, falling).z - 0.1) < 1e-4);
  run_until_rest(*world);
  world->move(moved, at(50, 0));
  run(*world, kSecond / 10);
  CHECK(place_of(*world, falling).z < 0.1 - kGravity_m_s2 * 0.1 * 0.1 / 4);
}

TEST_CASE("a body that floats slowly never stops") {
  const auto world = world_of(0);
  BodyDesc desc = cube(0, 0);
  constexpr double kSpeed_m_s = kRestSpeed_m_s / 2;
  desc.velocity_m_s = {kSpeed_m_s, 0, 0};
  const std::size_t id = world->add_body(desc);
  run(*world, 10 * kSecond);
  CHECK(place_of(*world, id).x == doctest::Approx(10 * kSpeed_m_s).epsilon(1e-9));
  CHECK(world->awake() == 1);
}

// A bar of 1 kg and 1 m on a joint about y at its end, at the horizontal.
ArticulationDesc stiff_bar() {
  LinkDesc link{.joint = JointKind::revolute, .axis = {0, 1, 0}};
  link.mass = {.mass_kg = 1, .center_m = {0.5, 0, 0}, .inertia_kg_m2 = glm::dmat3(1.0 / 12)};
  ArticulationDesc desc;
  desc.mass = {.mass_kg = 1, .center_m = {0, 0, 0}, .inertia_kg_m2 = glm::dmat3(1.0)};
  desc.links.push_back(link);
  return desc;
}

constexpr double kMoment_nm = kGravity_m_s2 * 0.5;  // of the bar's weight about the joint, at the horizontal

TEST_CASE("a joint whose damping is far too large for the step creeps as its damping says") {
  constexpr double kDamping =
      1e4;  // 30 times what its inertia of 1/3 loses in a step; explicit damping explodes from 2
  const auto world = world_of(kGravity_m_s2);
  ArticulationDesc desc = stiff_bar();
  desc.links[0].damping = kDamping;
  const std::size_t id = world->add_articulation(desc);
  run(*world, kSecond);
  // After the first steps gravity's moment is the damper's: both change by less than 1e-6 as the bar turns by 0.5 mrad.
  const double speed = kMoment_nm / kDamping;
  CHECK(std::abs(world->joint(id, 0).speed / speed - 1) < 1e-6);
}

TEST_CASE("a joint whose spring is far too stiff for the step rests where its spring carries the weight") {
  constexpr double kStiffness = 1e7;  // h^2 k / I is 30; explicit springs explode from 4
  const auto world = world_of(kGravity_m_s2);
  ArticulationDesc desc = stiff_bar();
  desc.links[0].stiffness = kStiffness;
  const std::size_t id = world->add_articulation(desc);
  run(*world, 2 * kSecond);
  const double angle = kMoment_nm / kStiffness;
  CHECK(std::abs(world->joint(id, 0).position / angle - 1) < 1e-6);
  CHECK(std::abs(world->joint(id, 0).speed) < 1e-9);
}

TEST_CASE("a servo that is too stiff for the step holds its target, with no more than its effort") {
  for (const double backward : {100.0, 99.0}) {  // the servo holds the weight by an effort below 0
    CAPTURE(backward);
    const auto world = world_of(kGravity_m_s2);
    const std::size_t id = world->add_articulation(stiff_bar());
    JointDrive drive{.kind = JointDrive::Kind::servo, .max_effort = 100};
    drive.stiffness = 1e7;
    drive.damping = 1e3;
    drive.min_effort = -backward;
    world->drive(id, 0, drive);
    run(*world, 2 * kSecond);
    CHECK(std::abs(world->joint(id, 0).position / (kMoment_nm / drive.stiffness) - 1) < 1e-6);
    drive.min_effort = -1;  // below the weight's moment: the bar falls
    world->drive(id, 0, drive);
    run(*world, kSecond / 10);
    // The moment that is left turns an inertia of 1/3 by 0.06 rad, at which gravity's moment is smaller by 0.2 %; of
    // 100 semi-implicit steps the last adds 1 %.
    const double fall = (kMoment_nm - 1) * 3 * 0.1 * 0.1 / 2;
    CHECK(std::abs(world->joint(id, 0).position / fall - 1) < 0.02);
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
