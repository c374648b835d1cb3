// Bodies in air and water, against closed formulas: drag, wind and buoyancy.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "elements/dynamics/forces/wind.h"
#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/mass.h"
#include "elements/dynamics/world/submerged.h"
#include "tests/support/moved_body.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

const double kPi = std::numbers::pi;

MovedBody falling_ball(const std::string& elements, const std::string& motion = "",
                       const std::string& before = kPhysics) {
  return {before + body("BALL", "shape='sphere' radius='0.1'", "mass='2' shape='sphere' " + motion) + elements, "BALL"};
}

// Euler's steps miss a speed whose derivative f(v) falls with v by at most h / 2 of the integral of |v''|. From rest v'
// falls from g to 0, so the integral is g; terms of order h^2 are a thousandth of that.
constexpr double kSpeedOfStep_m_s = 1.001 * kGravity_m_s2 * kStep_s / 2;

TEST_CASE("a ball in air comes near its terminal velocity as tanh, in a viscous flow as an exponential") {
  constexpr double kMass_kg = 2, kArea_m2 = 0.5, kShape = 0.47, kAir_kg_m3 = 1.225, kViscous = 3;
  const double fast = std::sqrt(2 * kMass_kg * kGravity_m_s2 / (kAir_kg_m3 * kShape * kArea_m2)),
               slow = kMass_kg * kGravity_m_s2 / kViscous;
  for (const double period_s : {0.01, 0.1}) {
    CAPTURE(period_s);
    MovedBody in_air = falling_ball("<element type='drag' name='D' insert_at='BALL' area='0.5' coefficient='0.47'/>");
    MovedBody viscous = falling_ball("<element type='drag' name='D' insert_at='BALL' linear='3'/>");
    for (int i = 1; i <= 4; ++i) {
      const double t = 0.5 * i;
      in_air.scene.run(t - 0.5, t, period_s);
      viscous.scene.run(t - 0.5, t, period_s);
      CHECK(std::abs(-in_air.motion().velocity_m_s.z - fast * std::tanh(kGravity_m_s2 * t / fast)) < kSpeedOfStep_m_s);
      CHECK(std::abs(-viscous.motion().velocity_m_s.z + slow * std::expm1(-kViscous / kMass_kg * t)) <
            kSpeedOfStep_m_s);
    }
    in_air.scene.run(2, 30, period_s);
    viscous.scene.run(2, 30, period_s);
    // What is left after 30 s: 2 e^(-2 g t / v) and e^(-t c / m) of the speed are below 1e-15.
    CHECK(std::abs(-in_air.motion().velocity_m_s.z / fast - 1) < 1e-12);
    CHECK(std::abs(-viscous.motion().velocity_m_s.z / slow - 1) < 1e-12);
  }
}

TEST_CASE("wind carries a body along until it stands in the air, at the point where the drag acts") {
  const std::string free = physics("gravity='0 0 0'");
  MovedBody ball = falling_ball(
      "<element type='wind' name='WIND' insert_at='ROOT' x='3' y='-4'/>"
      "<element type='drag' name='D' insert_at='BALL' linear='10' wind='WIND'/>",
      "", free);
  ball.scene.run(0, 10, 0.1);
  CHECK(glm::length(ball.motion().velocity_m_s - glm::dvec3(3, -4, 0)) < 1e-12);
  ball.scene.set("WIND", "x", 0);
  ball.scene.set("WIND", "y", 2);
  ball.scene.run(10, 20, 0.1);
  CHECK(glm::length(ball.motion().velocity_m_s - glm::dvec3(0, 2, 0)) < 1e-12);
  // A vane: the drag acts behind the centre of mass, so that the body turns until the point lies downwind.
  MovedBody vane = falling_ball(
      "<element type='wind' name='WIND' insert_at='ROOT' y='5'/>"
      "<element type='drag' name='D' insert_at='BALL' linear='0.05' point='-0.5 0 0' wind='WIND'/>"
      "<element type='drag' name='SPIN' insert_at='BALL' linear='0.05' point='0.5 0 0'/>",
      "", free);
  vane.scene.run(0, 0.02, 0.01);
  CHECK(vane.motion().angular_velocity_rad_s.z < 0);
}

TEST_CASE("no drag makes a body unstable, at its centre or at a long arm") {
  for (const char* const place : {"", "point='2 0 0'"}) {
    for (const char* const size : {"linear='1e9'", "area='1e6'"}) {
      CAPTURE(place);
      CAPTURE(size);
      MovedBody ball =
          falling_ball("<element type='drag' name='D' insert_at='BALL' " + std::string(place) + " " + size + "/>",
                       "velocity='10 0 -20'");
      ball.scene.run(0, 1, 0.1);
      const StepMotion::At at = ball.motion();
      const glm::dvec3 point = at.center_m + glm::dmat3(at.world_from_body) * glm::dvec3(*place != 0 ? 2 : 0, 0, 0);
      CHECK(glm::length(at.velocity_of(point)) < 30);
      CHECK(glm::length(at.velocity_m_s) < 30);
    }
  }
}

TEST_CASE("several strong drags of one body do not make it unstable") {
  std::string drags;
  for (const char* const name : {"D1", "D2", "D3"}) {
    drags += "<element type='drag' name='" + std::string(name) + "' insert_at='BALL' linear='1e9'/>";
  }
  MovedBody ball = falling_ball(drags, "velocity='10 0 -20'");
  ball.scene.run(0, 1, 0.1);
  CHECK(glm::length(ball.motion().velocity_m_s) < 30);
}

const WindElement& wind_of(MovingScene& scene) { return dynamic_cast<const WindElement&>(*(*scene).elements.front()); }

TEST_CASE("gusts follow from the run's seed, the name and the time alone, with their deviation and correlation") {
  const auto wind = [](std::uint64_t seed, const std::string& name = "WIND") {
    return MovingScene("<element type='wind' name='" + name + "' insert_at='ROOT' x='5' gust='1.5' gust_time='2'/>", "",
                       seed);
  };
  MovingScene one = wind(7), again = wind(7), other = wind(8), renamed = wind(7, "BREEZE");
  constexpr double kGust_m_s = 1.5, kMemory_s = 2, kKnot_s = kMemory_s / 8;
  const glm::dvec3 late = wind_of(one).velocity_m_s(1234.5678);
  for (const double t : {0.0, 0.1, 33.3}) {
    CHECK(wind_of(one).velocity_m_s(t) == wind_of(again).velocity_m_s(t));
    CHECK(glm::length(wind_of(one).velocity_m_s(t) - wind_of(other).velocity_m_s(t)) > 1e-3);
    CHECK(glm::length(wind_of(one).velocity_m_s(t) - wind_of(renamed).velocity_m_s(t)) > 1e-3);
  }
  CHECK(wind_of(again).velocity_m_s(1234.5678) == late);
  // Between knots the velocity changes evenly.
  const glm::dvec3 a = wind_of(one).velocity_m_s(kKnot_s), b = wind_of(one).velocity_m_s(2 * kKnot_s);
  CHECK(glm::length(wind_of(one).velocity_m_s(1.25 * kKnot_s) - glm::mix(a, b, 0.25)) < 1e-14);
  constexpr int kKnots = 20000;
  glm::dvec3 sum(0), square(0), lagged(0);
  std::vector<glm::dvec3> gusts;
  for (int i = 0; i < kKnots; ++i) gusts.push_back(wind_of(one).velocity_m_s(i * kKnot_s) - glm::dvec3(5, 0, 0));
  for (int i = 0; i + 8 < kKnots; ++i) {
    const auto at = static_cast<std::size_t>(i);
    sum += gusts[at];
    square += gusts[at] * gusts[at];
    lagged += gusts[at] * gusts[at + 8];
  }
  // Of N values with the correlation a^k, a = e^(-1/8), about N (1 - a) / (1 + a) count for the mean and N (1 - a^2) /
  // (1 + a^2) for squares: 1250 and 2480. Five standard deviations.
  const double mean_error = 5 * kGust_m_s / std::sqrt(1250.0), square_error = 5 * std::sqrt(2 / 2480.0);
  for (int axis = 0; axis < 3; ++axis) {
    CAPTURE(axis);
    CHECK(std::abs(sum[axis] / kKnots) < mean_error);
    CHECK(std::abs(square[axis] / kKnots / (kGust_m_s * kGust_m_s) - 1) < square_error);
    CHECK(std::abs(lagged[axis] / square[axis] - std::exp(-1.0)) < square_error);
  }
}

CollisionShape solid(CollisionKind kind, const glm::dvec3& half, const glm::dmat4& pose = glm::dmat4(1)) {
  return {.kind = kind, .body_from_shape = pose, .half_m = half};
}

glm::dvec3 direction(double tilt, double turn) {
  return {std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt)};
}

// The volume and the height of its centroid by 100,000 slices across z, each a segment of a disc: midpoints miss a
// square root at an end by about n^-1.5 of a slice.
struct Sliced {
  double volume = 0;
  glm::dvec3 first{0};
};
Sliced sliced(const std::function<double(double)>& radius, double low, double high, const glm::dvec3& up,
              double level) {
  constexpr int kSlices = 100000;
  const double across = std::hypot(up.x, up.y), width = (high - low) / kSlices;
  Sliced sum;
  for (int i = 0; i < kSlices; ++i) {
    const double z = low + (i + 0.5) * width, r = radius(z);
    const double e = std::clamp((level - up.z * z) / across, -r, r), rest = std::sqrt(r * r - e * e);
    const double area = r > 0 ? r * r * (kPi - std::acos(e / r)) + e * rest : 0;
    sum.volume += width * area;
    sum.first += width * glm::dvec3(-2.0 / 3 * rest * rest * rest / across * glm::dvec2(up), z * area);
  }
  return sum;
}

TEST_CASE("the submerged part of each solid: against slices, and against the part above") {
  const std::vector<glm::dvec3> corners = {{-0.3, -0.2, -0.1}, {0.4, -0.2, -0.1}, {0, 0.5, -0.2}, {0.1, 0, 0.6}};
  const CollisionShape hull = dynamics_engine().convex_hull(corners).value();
  const glm::dmat4 pose =
      glm::rotate(glm::translate(glm::dmat4(1), {0.1, -0.2, 0.3}), 0.7, glm::normalize(glm::dvec3(1, 2, 3)));
  const std::vector<CollisionShape> solids = {
      solid(CollisionKind::box, {0.3, 0.2, 0.1}), solid(CollisionKind::sphere, glm::dvec3(0.25)),
      solid(CollisionKind::cylinder, {0.2, 0.2, 0.3}), solid(CollisionKind::capsule, {0.15, 0.15, 0.2}), hull};
  // Rounding of a few dozen products; the quadrature of round solids has 1e-8.
  constexpr double kExact = 1e-13, kQuadrature = 1e-8;
  double worst = 0;
  int cut = 0;
  for (const CollisionShape& shape : solids) {
    CAPTURE(static_cast<int>(shape.kind));
    const bool is_turned = shape.kind == CollisionKind::cylinder || shape.kind == CollisionKind::capsule;
    const MassProperties whole = mass_of({&shape, 1}, 1);
    CollisionShape placed = shape;
    placed.body_from_shape = pose;
    for (const double tilt : {0.0, 1e-9, 0.3, 0.8, kPi / 2, 2.5, kPi}) {
      for (const double level : {-2.0, -0.29, -0.1, 0.0, 0.03, 0.2, 2.0, 1000.0}) {
        CAPTURE(tilt);
        CAPTURE(level);
        const glm::dvec3 up = direction(tilt, 0.4);
        const double tolerance = (is_turned ? kQuadrature : kExact) * whole.mass_kg;
        const SubmergedSolid wet = submerged({&shape, 1}, up, level), dry = submerged({&shape, 1}, -up, -level);
        CHECK(std::abs(wet.volume_m3 + dry.volume_m3 - whole.mass_kg) < tolerance);
        CHECK(glm::length(wet.volume_m3 * wet.center_m + dry.volume_m3 * dry.center_m -
                          whole.mass_kg * whole.center_m) < tolerance);
        if (wet.volume_m3 > 0 && dry.volume_m3 > 0) {
          ++cut;
          CHECK(glm::dot(up, wet.center_m) < level);
        }
        // The same water from another frame.
        const glm::dvec3 up_there = glm::dmat3(pose) * up;
        const double level_there = level + glm::dot(up_there, glm::dvec3(pose[3]));
        const SubmergedSolid there = submerged({&placed, 1}, up_there, level_there);
        const double rounding = tolerance + 1e-13 * std::abs(level) * whole.mass_kg;
        CHECK(std::abs(there.volume_m3 - wet.volume_m3) < rounding);
        if (!is_turned || std::sin(tilt) < 1e-3) continue;
        const double r = shape.half_m.x, half = shape.half_m.z;
        const bool has_ends = shape.kind == CollisionKind::capsule;
        const auto radius = [&](double z) {
          const double beyond = std::max(0.0, std::abs(z) - half);
          return std::sqrt(std::max(0.0, r * r - beyond * beyond));
        };
        const double end = has_ends ? half + r : half;
        const Sliced slow = sliced(radius, -end, end, up, level);
        worst = std::max({worst, std::abs(wet.volume_m3 - slow.volume) / whole.mass_kg,
                          glm::length(wet.volume_m3 * wet.center_m - slow.first) / whole.mass_kg});
      }
    }
  }
  CHECK(cut > 60);
  MESSAGE("cylinders and capsules differ from slices by at most " << worst << " of their volume");
  CHECK(worst < kQuadrature);
}

TEST_CASE("the submerged part of a cylinder whose side the water cuts is an oblique cylinder") {
  // V = pi r^2 h with h along the axis; the centroid lies at r^2 tan(a) / 4h aside and h/2 + r^2 tan(a)^2 / 8h up.
  constexpr double kRadius_m = 0.2, kHalf_m = 0.5, kTilt = 0.4, kAbove_m = 0.1;
  const CollisionShape shape = solid(CollisionKind::cylinder, {kRadius_m, kRadius_m, kHalf_m});
  const SubmergedSolid wet = submerged({&shape, 1}, direction(kTilt, 0), kAbove_m * std::cos(kTilt));
  const double h = kHalf_m + kAbove_m, r2 = kRadius_m * kRadius_m, t = std::tan(kTilt);
  CHECK(std::abs(wet.volume_m3 / (kPi * r2 * h) - 1) < 1e-13);
  CHECK(glm::length(wet.center_m - glm::dvec3(-r2 * t / (4 * h), 0, h / 2 + r2 * t * t / (8 * h) - kHalf_m)) < 1e-13);
}

struct Floater {
  std::string name, part, attributes;
  double half_height_m, depth_m;  // of the lowest point, where it floats
};

TEST_CASE("bodies float at the depth at which they displace their weight, and stay there") {
  // Half as dense as water, except for the ball: 0.15625 of a ball lie below a quarter of its diameter.
  const Floater floaters[] = {
      {"box", "shape='box' size='1 1 0.2'", "shape='box' density='500'", 0.1, 0.1},
      {"hull", "shape='box' size='1 1 0.2'", "shape='hull' density='700'", 0.1, 0.14},
      {"cylinder", "shape='cylinder' radius='0.5' length='0.2'", "shape='cylinder' density='300'", 0.1, 0.06},
      {"ball", "shape='sphere' radius='0.2'", "shape='sphere' density='156.25'", 0.2, 0.1},
      {"salt water", "shape='box' size='1 1 0.2'", "shape='box' density='515'", 0.1, 0.1}};
  for (const Floater& each : floaters) {
    CAPTURE(each.name);
    const double level_m = 3, rest_m = level_m - each.depth_m + each.half_height_m;
    const std::string water = "<element type='buoyancy' name='SEA' insert_at='B' level='3' " +
                              std::string(each.name == "salt water" ? "density='1030'" : "") + "/>";
    const auto at = [&](double z) { return each.part + " pose_offset='0 0 " + format_number(z) + " 0 0 0'"; };
    MovedBody still(kPhysics + body("B", at(rest_m), each.attributes) + water, "B");
    still.scene.run(0, 2, 0.1);
    // The volume is rounded, or integrated within 1e-8 of itself: 1e-8 g acts for at most 2 s.
    CHECK(std::abs(still.motion().center_m.z - rest_m) < 1e-8 * kGravity_m_s2 * 2 * 2);
    MovedBody dropped(kPhysics + body("B", at(rest_m + 0.05), each.attributes) + water +
                          "<element type='drag' name='D' insert_at='B' linear='400'/>",
                      "B");
    dropped.scene.run(0, 20, 0.5);
    CHECK(std::abs(dropped.motion().center_m.z - rest_m) < 1e-6);
    dropped.scene.set("SEA", "level", level_m + 0.5);
    dropped.scene.run(20, 40, 0.5);
    CHECK(std::abs(dropped.motion().center_m.z - rest_m - 0.5) < 1e-6);
  }
}

// The mean time between upward crossings of 0.
double period_of(MovingScene& scene, double until_s, const std::function<double()>& value) {
  double first_s = 0, last_s = 0, before = value();
  int crossings = 0;
  for (int i = 1; i * kStep_s < until_s; ++i) {
    scene.go_to(i * kStep_s);
    const double now = value();
    if (before < 0 && now >= 0) {
      last_s = i * kStep_s - kStep_s * now / (now - before);
      if (crossings++ == 0) first_s = last_s;
    }
    before = now;
  }
  REQUIRE(crossings > 4);
  return (last_s - first_s) / (crossings - 1);
}

TEST_CASE("a box bobs with the period of its weight on the water, and rolls with that of its metacentric height") {
  constexpr double kLength_m = 1, kBeam_m = 0.5, kHeight_m = 0.2, kShare = 0.5;
  const auto floating = [](const std::string& pose) {
    return MovingScene(
        kPhysics +
        body("BOX", "shape='box' size='1 0.5 0.2' pose_offset='0 0 " + pose + "'", "shape='box' density='500'") +
        "<element type='buoyancy' name='SEA' insert_at='BOX'/>");
  };
  // z'' = -g z / (share of the height): harmonic while the box is neither out nor under.
  MovingScene bobs = floating("0.05 0 0 0");
  const double bob_s = 2 * kPi * std::sqrt(kShare * kHeight_m / kGravity_m_s2);
  const double measured_s = period_of(bobs, 6, [&] { return bobs.position("BOX").z; });
  // Steps of h bring (w h)^2 / 24 into the period, 4e-6, and crossings are found to w h of a step.
  CHECK(std::abs(measured_s / bob_s - 1) < 1e-5);
  // GM = I / V - BG, with the water plane's I = L B^3 / 12 and the centroid of the displaced water at height / 4.
  MovingScene rolls = floating("0 1 0 0");
  const double mass_kg = 500 * kLength_m * kBeam_m * kHeight_m, volume = kLength_m * kBeam_m * kHeight_m * kShare;
  const double metacentric_m = kLength_m * std::pow(kBeam_m, 3) / 12 / volume - kHeight_m / 4;
  const double inertia = mass_kg * (kBeam_m * kBeam_m + kHeight_m * kHeight_m) / 12;
  const double roll_s = 2 * kPi * std::sqrt(inertia / (mass_kg * kGravity_m_s2 * metacentric_m));
  const double rolled_s = period_of(rolls, 12, [&] {
    const glm::dmat4 pose = rolls.pose("BOX");
    return std::atan2(pose[1].z, pose[2].z);
  });
  // The righting moment of an angle a differs from GM a by about a^2, 3e-4 at 1 degree.
  CHECK(std::abs(rolled_s / roll_s - 1) < 1e-3);
}

TEST_CASE("the surface of the water lies across gravity, and without gravity nothing floats") {
  // Gravity along -x: the water has x < 0.
  const std::string box = body("BOX", "shape='box' size='0.2 1 1'", "shape='box' density='500'") +
                          "<element type='buoyancy' name='SEA' insert_at='BOX'/>";
  MovedBody aside(physics("gravity='-9 0 0'") + box, "BOX");
  aside.scene.run(0, 1, 0.1);
  CHECK(glm::length(aside.motion().center_m) < 1e-12);
  MovedBody none(physics("gravity='0 0 0'") + box, "BOX");
  none.scene.run(0, 1, 0.1);
  CHECK(none.motion().center_m == glm::dvec3(0));
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
