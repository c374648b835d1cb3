// What steps of 1 ms do to the energy of bodies that nothing brakes: the figures in docs/dynamics.md.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dynamics/engine_module.h"
#include "dynamics/world.h"
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
