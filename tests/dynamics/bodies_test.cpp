// Rigid bodies against closed formulas.
#include <doctest/doctest.h>

#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>

#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// Sums of some thousand products of doubles, each rounded by 1e-16 of values of some metres.
constexpr double kRounding_m = 1e-11;

TEST_CASE("free fall: half of g t squared, and the share that the steps add to it") {
  MovingScene scene(kPhysics + body("BALL", "shape='sphere' radius='0.1' pose_offset='1 2 10 0 0 0'", "mass='3'"));
  for (const double t : {0.25, 1.0, 1.3}) {
    scene.go_to(t);
    // The speed is brought up to date before the position: z = -g h^2 n (n + 1) / 2 with n steps of h.
    const double drop = kGravity_m_s2 * t * (t + kStep_s) / 2;
    CHECK(std::abs(scene.position("BALL").z - (10 - drop)) < kRounding_m);
    // The part that is no free fall: g t h / 2.
    CHECK(std::abs(scene.position("BALL").z - (10 - kGravity_m_s2 * t * t / 2)) <=
          kGravity_m_s2 * t * kStep_s / 2 + kRounding_m);
  }
  CHECK(scene.position("BALL").x == doctest::Approx(1).epsilon(1e-15));
  CHECK(scene.get("BALL_BODY", "z") == doctest::Approx(scene.position("BALL").z - 10).epsilon(1e-12));
}

TEST_CASE("a thrown body flies its parabola, and damping slows it exponentially") {
  MovingScene scene(physics("gravity='0 0 0'") +
                    body("A", "shape='box' size='1 1 1'", "mass='1' velocity='2 0 0' linear_damping='0.5'") +
                    body("B", "shape='box' size='1 1 1' pose_offset='0 5 0 0 0 0'", "mass='1' velocity='2 -1 0'") +
                    body("C", "shape='box' size='1 1 1' pose_offset='0 9 0 0 0 0'",
                         "mass='1' angular_velocity='0 0 60' angular_damping='0.5'"));
  scene.go_to(2);
  CHECK(glm::length(scene.position("B") - glm::dvec3(4, 3, 0)) < kRounding_m);
  // The integral of 2 e^(-t/2); a sum of steps instead of it is off by at most the speed's loss in one step, v h.
  CHECK(std::abs(scene.position("A").x - 4 * (1 - std::exp(-1))) < 2 * kStep_s);
  const double turned = std::atan2(scene.pose("C")[0].y, scene.pose("C")[0].x), turn = glm::radians(60.0);
  CHECK(std::abs(turned - 2 * turn * (1 - std::exp(-1))) < turn * kStep_s);
}

TEST_CASE("a ball bounces to the height that its restitution leaves") {
  constexpr double kHeight_m = 1, kRadius_m = 0.1, kLeft = 0.8;
  MovingScene scene(kPhysics + ground("restitution='1'") +
                    body("BALL", "shape='sphere' radius='0.1' pose_offset='0 0 1.1 0 0 0'",
                         "shape='sphere' mass='1' restitution='0.8'"));
  const double fall_s = std::sqrt(2 * kHeight_m / kGravity_m_s2);
  double highest = 0, lowest = 1;
  for (double t = fall_s; t < fall_s * (1 + 2 * kLeft); t += kStep_s) {
    scene.go_to(t);
    lowest = std::min(lowest, scene.position("BALL").z - kRadius_m);
    if (t > 1.1 * fall_s) highest = std::max(highest, scene.position("BALL").z - kRadius_m);
  }
  // The bounce comes within one step of the exact time: the height is off by v h before it, of which e^2 is left, and
  // by v h after it; the height of a flight in steps is off by v h / 2 both times.
  const double speed = std::sqrt(2 * kGravity_m_s2 * kHeight_m);
  CHECK(std::abs(highest - kLeft * kLeft * kHeight_m) < 2 * (1 + kLeft * kLeft) * speed * kStep_s);
  CHECK(lowest > -speed * kStep_s);
}

// The greatest height of a ball over the floor between two hits, after a fall from this height.
double rebound_m(const std::string& ball, const std::string& floor, double height_m) {
  constexpr double kRadius_m = 0.1;
  MovingScene scene(
      kPhysics + ground("restitution='" + floor + "'") +
      body("BALL", "shape='sphere' radius='0.1' pose_offset='0 0 " + format_number(height_m + kRadius_m) + " 0 0 0'",
           "shape='sphere' mass='1' restitution='" + ball + "'"));
  const double fall_s = std::sqrt(2 * height_m / kGravity_m_s2);
  double highest = 0;
  for (double t = fall_s + 2 * kStep_s; t < 3 * fall_s; t += kStep_s) {
    scene.go_to(t);
    highest = std::max(highest, scene.position("BALL").z - kRadius_m);
  }
  return highest;
}

TEST_CASE("a bounce leaves the product of both restitutions, whichever of the bodies has which") {
  constexpr double kHeight_m = 1;
  const double speed = std::sqrt(2 * kGravity_m_s2 * kHeight_m);
  const std::string restitutions[] = {"0", "0.01", "0.5", "1"};
  for (const std::string& ball : restitutions) {
    for (const std::string& floor : restitutions) {
      CAPTURE(ball);
      CAPTURE(floor);
      const double left = std::stod(ball) * std::stod(floor);
      const double height = rebound_m(ball, floor, kHeight_m);
      if (left == 0) {
        // It stops at the surface. Bullet's margin around each shape, 4 cm, is rounded to a float: by 2^-25 of it.
        CHECK(height < 2 * 0.04 * 0x1p-25);
        continue;
      }
      // The speed is turned round at the last step before the touch, up to v h above the floor; of this height the
      // bounce takes no share. The height of a flight in steps is off by v h / 2 both times, but for g h^2 / 8.
      const double early = ((1 - left * left) + left * (1 - left) / 2) * speed * kStep_s;
      CHECK(std::abs(height - left * left * kHeight_m) <= early + kGravity_m_s2 * kStep_s * kStep_s);
    }
  }
}

TEST_CASE("a ball that bounces comes to rest on the floor") {
  MovingScene scene(kPhysics + ground("restitution='1'") +
                    body("BALL", "shape='sphere' radius='0.1' pose_offset='0 0 1.1 0 0 0'",
                         "shape='sphere' mass='1' restitution='0.8'"));
  // The sum of all flights is t (1 + e) / (1 - e) = 4.1 s.
  scene.go_to(6);
  const double z = scene.position("BALL").z;
  CHECK(std::abs(z - 0.1) < 1e-3);
  for (int i = 1; i <= 1000; ++i) {
    scene.go_to(6 + i * kStep_s);
    CHECK(std::abs(scene.position("BALL").z - z) < kRounding_m);
  }
}

TEST_CASE("a box on a slope slides with g (sin - mu cos), or stays") {
  // Gravity leans by 30 degrees instead of the floor.
  const double lean = glm::radians(30.0);
  char gravity[96];
  std::snprintf(gravity, sizeof(gravity), "gravity='%.17g 0 %.17g'", kGravity_m_s2 * std::sin(lean),
                -kGravity_m_s2 * std::cos(lean));
  const auto slid = [&](const char* friction) {
    MovingScene scene(physics(gravity) + ground("friction='1'") +
                      body("BOX", "shape='box' size='0.4 0.4 0.2' pose_offset='0 0 0.1 0 0 0'",
                           std::string("shape='box' mass='2' friction='") + friction + "'"));
    scene.go_to(1);
    CHECK(std::abs(scene.position("BOX").z - 0.1) < 1e-3);
    CHECK(std::abs(scene.position("BOX").y) < 1e-6);
    return scene.position("BOX").x;
  };
  // In steps: a t (t + h) / 2. The normal force settles in the first steps, some ten of them, at up to mu g cos:
  // a speed of 10 h mu g cos over one second.
  const double g_cos = kGravity_m_s2 * std::cos(lean), g_sin = kGravity_m_s2 * std::sin(lean);
  const double expected = (g_sin - 0.3 * g_cos) * (1 + kStep_s) / 2;
  CHECK(std::abs(slid("0.3") - expected) < 10 * kStep_s * 0.3 * g_cos);
  CHECK(slid("0") == doctest::Approx(g_sin * (1 + kStep_s) / 2).epsilon(1e-9));
  // tan 30 degrees is 0.577.
  CHECK(slid("0.6") < 1e-3);
  CHECK(slid("0.55") > 1e-2);
}

TEST_CASE("a top without forces precesses about its angular momentum") {
  // Moments A = B = 0.02, C = 0.03; spin 20 rad/s about the axis z of the body, 2 rad/s about x.
  constexpr double kA = 0.02, kC = 0.03, kSpin = 20, kCross = 2;
  MovingScene scene(physics("gravity='0 0 0'") +
                    body("TOP", "shape='cylinder' radius='0.2' length='0.1'",
                         "shape='cylinder' mass='1' inertia='0.02 0.02 0.03' angular_velocity='" +
                             format_number(glm::degrees(kCross)) + " 0 " + format_number(glm::degrees(kSpin)) + "'"));
  const glm::dvec3 momentum(kA * kCross, 0, kC * kSpin);
  const double rate = glm::length(momentum) / kA;  // of the axis about the momentum
  const glm::dvec3 about = glm::normalize(momentum);
  // The steps turn the body by its speed at their end: an error of the rate of about rate^2 h / 2 each, so the axis is
  // off by at most cone * rate^2 h t / 2, where the cone is the angle between both.
  const double cone = std::acos(about.z);
  for (const double t : {0.1, 0.3, 0.5}) {
    scene.go_to(t);
    const double angle = rate * t, c = std::cos(angle), s = std::sin(angle);
    const glm::dvec3 z(0, 0, 1);
    const glm::dvec3 expected = c * z + s * glm::cross(about, z) + (1 - c) * glm::dot(about, z) * about;
    CHECK(glm::length(glm::dvec3(scene.pose("TOP")[2]) - expected) < cone * rate * rate * kStep_s * t / 2);
  }
}

TEST_CASE("ten boxes on each other stand") {
  std::string xml = kPhysics + ground();
  for (int i = 0; i < 10; ++i) {
    xml += body("BOX" + std::to_string(i),
                "shape='box' size='0.2 0.2 0.2' pose_offset='0 0 " + format_number(0.1 + 0.2 * i) + " 0 0 0'",
                "shape='box' density='500'");
  }
  MovingScene scene(xml);
  scene.run(0, 4, 0.1);
  // Contacts rest at an overlap of less than 0.1 mm each.
  for (int i = 0; i < 10; ++i) {
    const glm::dvec3 at = scene.position("BOX" + std::to_string(i));
    CHECK(glm::length(at - glm::dvec3(0, 0, 0.1 + 0.2 * i)) < (i + 1) * 1e-4);
  }
}

TEST_CASE("a kinematic body pushes others, and follows the elements that move it") {
  MovingScene scene(
      kPhysics + ground() +
      "<part name='PUSHER' insert_at='ROOT' shape='box' size='0.2 1 0.5' pose_offset='0 0 0.3 0 0 0'/>"
      "<element type='pose' name='PUSH' insert_at='PUSHER'/>"
      "<element type='body' name='PUSHER_BODY' insert_at='PUSHER' kind='kinematic' shape='box'/>" +
      body("BOX", "shape='box' size='0.4 0.4 0.4' pose_offset='0.5 0 0.2 0 0 0'", "shape='box' mass='5'"));
  for (int i = 1; i <= 50; ++i) {
    scene.set("PUSH", "x", 0.02 * i);
    scene.go_to(0.04 * i);
  }
  CHECK(scene.position("PUSHER").x == 1);
  // The pusher's face is at 1.1, the box reaches 0.2 to either side of its middle, and friction stops it at once.
  CHECK(std::abs(scene.position("BOX").x - 1.3) < 2e-3);
}

TEST_CASE("a value that is set puts a dynamic body there at rest") {
  MovingScene scene(kPhysics + body("BALL", "shape='sphere' radius='0.1' pose_offset='0 0 3 0 0 0'", "mass='1'"));
  scene.go_to(0.5);
  scene.set("BALL_BODY", "x", 7);
  scene.set("BALL_BODY", "z", 1);
  scene.go_to(0.6);
  CHECK(std::abs(scene.position("BALL").x - 7) < kRounding_m);
  CHECK(std::abs(scene.position("BALL").z - (4 - kGravity_m_s2 * 0.1 * (0.1 + kStep_s) / 2)) < kRounding_m);
}

TEST_CASE("mass and inertia follow from density and shape") {
  // Two boxes joined at their ends turn about a common centre: the body falls without turning only if the centre of
  // mass is where the pull acts, and its own frame lies elsewhere.
  MovingScene scene(physics("gravity='0 0 0'") + body("ROD", "shape='box' size='1 0.1 0.1'",
                                                      "shape='box' density='1000' center='0.5 0 0' "
                                                      "angular_velocity='0 0 90'"));
  scene.go_to(1);
  // A quarter of a turn about the end (0.5, 0, 0): the middle comes to (0.5, -0.5, 0).
  CHECK(glm::length(scene.position("ROD") - glm::dvec3(0.5, -0.5, 0)) < 1e-9);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
