// Drives by position whose effort is small: they brake in time, whatever else acts on the joint.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "elements/dynamics/world/engine_module.h"
#include "elements/dynamics/world/world.h"
#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

constexpr double kGain_per_s = 20;  // that of the element robot

struct Driven {
  JointKind joint = JointKind::revolute;
  glm::dvec3 axis{0, 0, 1};
  double start = 0, target = 0, effort = 0;
  glm::dvec3 base_m{0};
};

// A bar of 1 kg and 1 m from the joint along x, or what slides with it.
LinkDesc driven_bar(const Driven& driven) {
  LinkDesc link{.joint = driven.joint, .axis = driven.axis, .position = driven.start};
  link.mass = {.mass_kg = 1, .center_m = {0.5, 0, 0}, .inertia_kg_m2 = glm::dmat3(1.0 / 12)};
  return link;
}

JointDrive position_drive(double target, double effort) {
  return {.kind = JointDrive::Kind::position,
          .target = target,
          .max_effort = effort,
          .gain_per_s = kGain_per_s,
          .max_speed = 1e6};
}

struct Driving {
  std::unique_ptr<DynamicsWorld> world;
  std::size_t id = 0;
};

Driving driving(const std::vector<LinkDesc>& links, const glm::dvec3& base_m = {}) {
  ArticulationDesc desc;
  desc.mass = {.mass_kg = 1, .center_m = {0, 0, 0}, .inertia_kg_m2 = glm::dmat3(1.0)};
  desc.world_from_base[3] = glm::dvec4(base_m, 1);
  desc.links = links;
  Driving made{
      dynamics_engine().make_world({.gravity_m_s2 = {0, 0, -kGravity_m_s2}, .step_s = kStep_s, .iterations = 50})};
  made.id = made.world->add_articulation(desc);
  return made;
}

struct Arrival {
  double overshoot = 0;  // beyond the target, in the direction of the way
  double arrives_s = 0;  // from then on it is nearer than 1 % of the way
  double last = 0;       // distance at the end
};

Arrival drive(const Driven& driven, double seconds) {
  Driving made = driving({driven_bar(driven)}, driven.base_m);
  const double way = driven.target - driven.start;
  Arrival arrival;
  for (int i = 1; i <= static_cast<int>(seconds / kStep_s); ++i) {
    made.world->drive(made.id, 0, position_drive(driven.target, driven.effort));
    REQUIRE_FALSE(made.world->step());
    const double left = driven.target - made.world->joint(made.id, 0).position;
    arrival.overshoot = std::max(arrival.overshoot, -left * (way > 0 ? 1 : -1));
    if (std::abs(left) > std::abs(way) / 100) arrival.arrives_s = i * kStep_s;
    arrival.last = std::abs(left);
  }
  return arrival;
}

TEST_CASE("a drive by position with little effort does not overshoot") {
  const double pi = std::numbers::pi;
  // Gravity exerts up to 4.9 N m about y, and 9.8 N along z.
  const Driven all[] = {
      {.axis = {0, 0, 1}, .target = 3, .effort = 0.5},
      {.axis = {0, 0, 1}, .target = -3, .effort = 0.5},
      {.axis = {0, 0, 1}, .target = 3, .effort = 0.5, .base_m = {1e4, -2e4, 10}},
      {.axis = {0, 1, 0}, .start = 0, .target = pi / 2, .effort = 7},        // falls to where it hangs
      {.axis = {0, 1, 0}, .start = -pi / 2, .target = 0, .effort = 7},       // falls to the horizontal
      {.axis = {0, 1, 0}, .start = pi / 2, .target = -pi / 2, .effort = 7},  // up
      {.joint = JointKind::prismatic, .axis = {1, 0, 0}, .target = 2, .effort = 2},
      {.joint = JointKind::prismatic, .axis = {0, 0, 1}, .target = -2, .effort = 14},
      {.joint = JointKind::prismatic, .axis = {0, 0, 1}, .target = 2, .effort = 14},
  };
  for (const Driven& driven : all) {
    CAPTURE(driven.target);
    CAPTURE(driven.effort);
    CAPTURE(driven.start);
    const Arrival arrival = drive(driven, 8);
    const double way = std::abs(driven.target - driven.start);
    // What gravity does in one step is what is left: g h / gain over the lever.
    CHECK(arrival.overshoot < 1e-3 * way);
    CHECK(arrival.last < 1e-3 * way);
    // At least as long as the fastest motion without gravity: half of the way at full effort, and half against it.
    const double inertia = driven.joint == JointKind::prismatic ? 1 : 1.0 / 12 + 0.25;
    const double fastest_s = 2 * std::sqrt(way * inertia / driven.effort);
    CHECK(arrival.arrives_s < 2.5 * fastest_s + 5 / kGain_per_s);
  }
}

TEST_CASE("two joints of an arm with little effort that move at the same time overshoot by little") {
  const Driven shoulder{.target = 3, .effort = 2}, elbow{.target = -2, .effort = 1};
  std::vector<LinkDesc> links = {driven_bar(shoulder), driven_bar(elbow)};
  links[1].parent = 0;
  links[1].parent_from_joint[3] = {1, 0, 0, 1};
  Driving made = driving(links);
  double overshoot = 0, left = 0;
  for (int i = 0; i < 10'000; ++i) {
    made.world->drive(made.id, 0, position_drive(shoulder.target, shoulder.effort));
    made.world->drive(made.id, 1, position_drive(elbow.target, elbow.effort));
    REQUIRE_FALSE(made.world->step());
    const double a = shoulder.target - made.world->joint(made.id, 0).position,
                 b = made.world->joint(made.id, 1).position - elbow.target;
    overshoot = std::max({overshoot, -a, -b});
    left = std::max(std::abs(a), std::abs(b));
  }
  MESSAGE("two joints overshoot by " << glm::degrees(overshoot) << " degrees");
  CHECK(overshoot < glm::radians(5.0));
  CHECK(left < 1e-4);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
