// Pulls at bodies by a damped spring.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "tests/support/moved_body.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// The way by which the weight stretches the spring: gravity divided by the square of 8 rad/s.
constexpr double kSag_m = kGravity_m_s2 / 64;
// Critically damped, after 4 s: the share e^-32 (1 + 32) of 2 m is left.
constexpr double kLeft_m = 2 * 33 * 1.3e-14;
// Rounding of 4000 steps.
constexpr double kSteps_m = 1e-9;

constexpr std::uint64_t kHand = 3, kOtherHand = 8;

TEST_CASE("a body follows the hand, hangs below it, and falls when it is let go") {
  MovingScene scene(kPhysics + ground() +
                    body("BALL", "shape='sphere' radius='0.1' pose_offset='0 0 0.1 0 0 0'", "mass='5'"));
  SensedPhysics& physics = physics_of(scene);
  physics.pull(kHand, BodyPull{.body = 1, .body_m = {0, 0, 0}, .target_m = {1, 0, 2}});
  scene.run(0, 4, 0.1);
  CHECK(glm::length(scene.position("BALL") - glm::dvec3(1, 0, 2 - kSag_m)) < kLeft_m + kSteps_m);
  physics.pull(kHand, {});
  scene.run(4, 6, 0.1);
  CHECK(scene.position("BALL").z < 0.11);
}

TEST_CASE("a body that rests follows too, and one that no force moves does not") {
  MovingScene scene(kPhysics + ground() +
                    body("BOX", "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 0.1 0 0 0'", "mass='5' shape='box'"));
  scene.run(0, 4, 0.1);  // it has come to rest, and costs nothing
  SensedPhysics& physics = physics_of(scene);
  physics.pull(kHand, BodyPull{.body = 1, .body_m = {0, 0, 0.1}, .target_m = {0, 0, 1}});
  scene.run(4, 8, 0.1);
  CHECK(scene.position("BOX").z > 0.5);
  // A grip far outside the body acts at an arm of at most twice the distance of its corners.
  physics.pull(kHand, BodyPull{.body = 1, .body_m = {0, 4000, 0}, .target_m = {0, 4000, 1}});
  physics.follow_points({"BOX"});
  scene.go_to(8 + kStep_s);
  constexpr double kMaxPull_m_s2 = 100, kEdge_m = 0.2, kReach_m = kEdge_m * 1.7321;  // twice half of its diagonal
  const double turn = glm::length(physics.motion_of("BOX").value().after.angular_velocity_rad_s);
  CHECK(turn <= kMaxPull_m_s2 * kReach_m / (kEdge_m * kEdge_m / 6) * kStep_s);
  CHECK_NOTHROW(scene.run(8, 12, 0.1));
  CHECK(error_of([&] { physics.pull(kHand, BodyPull{.body = 0}); }) == "no force moves \"GROUND\"");
  CHECK(error_of([&] { physics.pull(kHand, BodyPull{.body = 2}); }) == "there is no body 2");
  for (const double far_m : {1e16, -1e308}) {
    CHECK(contains(error_of([&] {
                     physics.pull(kHand, BodyPull{.body = 1, .body_m = {0, far_m, 0}});
                   }),
                   "is out of range"));
    CHECK(contains(error_of([&] {
                     physics.pull(kHand, BodyPull{.body = 1, .target_m = {0, 0, far_m}});
                   }),
                   "is out of range"));
  }
}

TEST_CASE("two hands pull at two bodies, and one lets go of its own") {
  const auto ball = [](const std::string& name, const std::string& y) {
    return body(name, "shape='sphere' radius='0.1' pose_offset='0 " + y + " 0.1 0 0 0'", "mass='5'");
  };
  MovingScene scene(kPhysics + ground() + ball("LEFT", "1") + ball("RIGHT", "-1"));
  SensedPhysics& physics = physics_of(scene);
  physics.pull(kHand, BodyPull{.body = 1, .body_m = {0, 0, 0}, .target_m = {0, 1, 1}});
  physics.pull(kOtherHand, BodyPull{.body = 2, .body_m = {0, 0, 0}, .target_m = {0, -1, 2}});
  scene.run(0, 4, 0.1);
  CHECK(glm::length(scene.position("LEFT") - glm::dvec3(0, 1, 1 - kSag_m)) < kLeft_m + kSteps_m);
  CHECK(glm::length(scene.position("RIGHT") - glm::dvec3(0, -1, 2 - kSag_m)) < kLeft_m + kSteps_m);
  physics.pull(kHand, {});
  scene.run(4, 6, 0.1);
  CHECK(scene.position("LEFT").z < 0.11);
  CHECK(glm::length(scene.position("RIGHT") - glm::dvec3(0, -1, 2 - kSag_m)) < kLeft_m + kSteps_m);
}

// Each spring has half the strength, so that both are as one to the place between the hands.
TEST_CASE("two hands at one body hold it between them with the strength of one") {
  MovingScene scene(kPhysics + ground() +
                    body("BALL", "shape='sphere' radius='0.1' pose_offset='0 0 0.1 0 0 0'", "mass='5'"));
  SensedPhysics& physics = physics_of(scene);
  physics.pull(kHand, BodyPull{.body = 1, .body_m = {0, 0, 0}, .target_m = {0.5, 0, 1}});
  physics.pull(kOtherHand, BodyPull{.body = 1, .body_m = {0, 0, 0}, .target_m = {-0.1, 0, 1}});
  scene.run(0, 4, 0.1);
  CHECK(glm::length(scene.position("BALL") - glm::dvec3(0.2, 0, 1 - kSag_m)) < kLeft_m + kSteps_m);
}

TEST_CASE("a vehicle is lifted by its body or by a wheel") {
  for (const std::size_t held : {1u, 2u}) {
    CAPTURE(held);
    MovingScene scene(
        kPhysics + ground() +
        "<part name='CAR' insert_at='ROOT' shape='box' size='0.4 0.2 0.1' pose_offset='0 0 0 0 0 0'/>"
        "<element type='vehicle' name='DRIVE' insert_at='CAR' mass='10' wheel_radius='0.1' track='0.4'/>");
    physics_of(scene).pull(kHand, BodyPull{.body = held, .body_m = {0, 0, 0}, .target_m = {0, 0, 2}});
    scene.run(0, 4, 0.1);
    CHECK(scene.position("CAR").z > 1);
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
