// What steps of 1 ms do to the energy of bodies that nothing brakes: the figures in docs/dynamics.md.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/world.h"
#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kEnergyRun_s = 60;
constexpr int kEnergySteps = static_cast<int>(kEnergyRun_s / kStep_s);

// A bar of 1 kg and 1 m on a joint about y at its end, at the horizontal at first. Positive angles bring it down.
ArticulationDesc bar(double start_rad) {
  LinkDesc link{.joint = JointKind::revolute, .axis = {0, 1, 0}, .position = start_rad};
  link.mass = {.mass_kg = 1, .center_m = {0.5, 0, 0}, .inertia_kg_m2 = glm::dmat3(1.0 / 12)};
  ArticulationDesc desc;
  desc.mass = {.mass_kg = 1, .center_m = {0, 0, 0}, .inertia_kg_m2 = glm::dmat3(1.0)};
  desc.links.push_back(link);
  return desc;
}

TEST_CASE("the energy of a pendulum drifts by less than its swing within a step") {
  for (const double swing_deg : {20.0, 90.0}) {
    CAPTURE(swing_deg);
    const auto world =
        dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -kGravity_m_s2}, .step_s = kStep_s, .iterations = 50});
    const double swing = glm::radians(swing_deg), lowest = std::numbers::pi / 2;
    const std::size_t id = world->add_articulation(bar(lowest - swing));
    const double about_joint = 1.0 / 12 + 0.25, most = kGravity_m_s2 * 0.5 * (1 - std::cos(swing));
    double worst = 0, last = 0;
    for (int i = 0; i < kEnergySteps; ++i) {
      REQUIRE_FALSE(world->step());
      const JointState state = world->joint(id, 0);
      const double energy =
          about_joint * state.speed * state.speed / 2 + kGravity_m_s2 * 0.5 * (1 - std::cos(state.position - lowest));
      last = energy / most - 1;
      worst = std::max(worst, std::abs(last));
    }
    MESSAGE("pendulum, " << swing_deg << " degrees: energy differs by at most " << worst << ", after 60 s by " << last);
    // The steps keep an energy that differs from the true one by h / 2 of speed times gravity's moment: a share of
    // w h / 2 for small swings, where w is the rate of the swing, and no more for large ones.
    const double rate = std::sqrt(kGravity_m_s2 * 0.5 / about_joint);
    CHECK(worst < rate * kStep_s);
  }
}

// Two bars like that one, the second at the end of the first. Angles are from the horizontal, speeds their derivatives.
struct TwoBars {
  double a = 0, b = 0, speed_a = 0, speed_b = 0;
  TwoBars operator+(const TwoBars& o) const { return {a + o.a, b + o.b, speed_a + o.speed_a, speed_b + o.speed_b}; }
  TwoBars operator*(double by) const { return {a * by, b * by, speed_a * by, speed_b * by}; }
};

constexpr double kOfFirst = 1.0 / 12 + 0.25 + 1, kOfSecond = 1.0 / 12 + 0.25, kOfBoth = 0.5;  // inertias in kg m^2

// Lagrange's equations: M (acceleration) = forces.
TwoBars derivative(const TwoBars& now) {
  const double mixed = kOfBoth * std::cos(now.a - now.b), sine = kOfBoth * std::sin(now.a - now.b);
  const double force_a = 1.5 * kGravity_m_s2 * std::cos(now.a) - sine * now.speed_b * now.speed_b,
               force_b = 0.5 * kGravity_m_s2 * std::cos(now.b) + sine * now.speed_a * now.speed_a;
  const double determinant = kOfFirst * kOfSecond - mixed * mixed;
  return {now.speed_a, now.speed_b, (kOfSecond * force_a - mixed * force_b) / determinant,
          (kOfFirst * force_b - mixed * force_a) / determinant};
}

double energy_of(const TwoBars& now) {
  return kOfFirst * now.speed_a * now.speed_a / 2 + kOfSecond * now.speed_b * now.speed_b / 2 +
         kOfBoth * std::cos(now.a - now.b) * now.speed_a * now.speed_b -
         kGravity_m_s2 * (1.5 * std::sin(now.a) + 0.5 * std::sin(now.b));
}

// The method of Runge and Kutta of order 4: at this step its own error is below 1e-9.
TwoBars exact_two_bars(double seconds) {
  constexpr double kFine_s = 1e-4;
  TwoBars now;
  for (int i = 0; i < static_cast<int>(seconds / kFine_s + 0.5); ++i) {
    const TwoBars k1 = derivative(now), k2 = derivative(now + k1 * (kFine_s / 2)),
                  k3 = derivative(now + k2 * (kFine_s / 2)), k4 = derivative(now + k3 * kFine_s);
    now = now + (k1 + k2 * 2 + k3 * 2 + k4) * (kFine_s / 6);
  }
  return now;
}

struct TwoBarsRun {
  double distance_rad = 0;  // of the angles from the exact ones at the end
  double drift = 0;         // largest change of the energy, as a share of the energy of the lowest place
};

TwoBarsRun run_two_bars(double step_s, double seconds, const TwoBars& exact) {
  const auto world =
      dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -kGravity_m_s2}, .step_s = step_s, .iterations = 50});
  ArticulationDesc desc = bar(0);
  desc.links.push_back(desc.links[0]);
  desc.links[1].parent = 0;
  desc.links[1].parent_from_joint[3] = {1, 0, 0, 1};
  const std::size_t id = world->add_articulation(desc);
  TwoBarsRun run;
  TwoBars now;
  for (int i = 0; i < static_cast<int>(seconds / step_s + 0.5); ++i) {
    REQUIRE_FALSE(world->step());
    const JointState first = world->joint(id, 0), second = world->joint(id, 1);
    now = {first.position, first.position + second.position, first.speed, first.speed + second.speed};
    run.drift = std::max(run.drift, std::abs(energy_of(now)) / (2 * kGravity_m_s2));
  }
  run.distance_rad = std::hypot(now.a - exact.a, now.b - exact.b);
  return run;
}

TEST_CASE("a double pendulum converges with the step, and so does its energy") {
  constexpr double kRun_s = 2;
  const TwoBars exact = exact_two_bars(kRun_s);
  TwoBarsRun before;
  for (const double step_s : {1e-3, 0.5e-3, 0.25e-3, 0.125e-3}) {
    const TwoBarsRun run = run_two_bars(step_s, kRun_s, exact);
    MESSAGE("double pendulum, step of " << step_s << " s: " << run.distance_rad << " rad away after " << kRun_s
                                        << " s, energy differs by at most " << run.drift);
    // Order 1: half of the step halves both. The next order is a share of w h of that, at rates w of up to 20 rad/s.
    if (before.distance_rad > 0) {
      CHECK(std::abs(before.distance_rad / run.distance_rad - 2) < 0.2);
      CHECK(std::abs(before.drift / run.drift - 2) < 0.2);
    }
    before = run;
  }
}

TEST_CASE("a free gyroscope keeps its momentum, and its energy within what the table says") {
  const auto world = dynamics_engine().make_world({.gravity_m_s2 = {0, 0, 0}, .step_s = kStep_s, .iterations = 50});
  const glm::dvec3 moments(0.02, 0.025, 0.03);
  BodyDesc top;
  top.shapes = {{.kind = CollisionKind::sphere, .half_m = glm::dvec3(0.1)}};
  top.mass = {.mass_kg = 1, .center_m = {0, 0, 0}, .inertia_kg_m2 = {{0.02, 0, 0}, {0, 0.025, 0}, {0, 0, 0.03}}};
  top.angular_velocity_rad_s = {1, 0.5, 20};
  const std::size_t id = world->add_body(top);
  const auto energy_and_momentum = [&] {
    const BodyState state = world->state(id);
    const glm::dmat3 axes(state.world_from_body);
    const glm::dvec3 own = glm::transpose(axes) * state.angular_velocity_rad_s;
    return std::pair(glm::dot(own, moments * own) / 2, glm::length(moments * own));
  };
  const auto [energy, momentum] = energy_and_momentum();
  double worst_energy = 0, worst_momentum = 0;
  for (int i = 0; i < kEnergySteps; ++i) {
    REQUIRE_FALSE(world->step());
    const auto [e, m] = energy_and_momentum();
    worst_energy = std::max(worst_energy, std::abs(e / energy - 1));
    worst_momentum = std::max(worst_momentum, std::abs(m / momentum - 1));
  }
  MESSAGE("gyroscope: energy differs by at most " << worst_energy << ", momentum by " << worst_momentum);
  // A step turns it by w h, and mixes by this share what its axes have.
  CHECK(worst_energy < 20 * kStep_s);
  CHECK(worst_momentum < 20 * kStep_s);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
