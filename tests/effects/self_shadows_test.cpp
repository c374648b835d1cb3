// Surfaces that a lamp reaches are not shaded by themselves or by what meets them.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/shadow_floor.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

TEST_CASE("no surface shades itself: grazing light on planes equals the picture without shadows to the bit") {
  for (const double elevation : {0.3, 2.0, 20.0, 89.0}) {
    for (const double azimuth : {0.0, 33.0, 200.0}) {
      CAPTURE(elevation);
      CAPTURE(azimuth);
      const Floor floor{.light = sun(azimuth, elevation, 64)};
      const RendererScene scene = floor.scene();
      const std::vector<glm::vec4> seen = picture(scene, with_shadows(scene, floor.plan()));
      CHECK(same_bytes(std::span<const glm::vec4>(seen), {picture_without(scene, floor.plan())}));
    }
  }
}

// The floor from an eye that looks along it and is turned about its axis.
FramePlan edge_on(const Floor& floor, const glm::dvec3& eye, double yaw_rad, double pitch_rad, double roll_rad) {
  FramePlan plan = floor.plan();
  const double c = std::cos(pitch_rad), s = std::sin(pitch_rad);
  const glm::dvec3 forward(c * std::cos(yaw_rad), c * std::sin(yaw_rad), s),
      level(std::sin(yaw_rad), -std::cos(yaw_rad), 0), below = glm::cross(forward, level),
                                                       right = std::cos(roll_rad) * level + std::sin(roll_rad) * below;
  view_of(plan).view_from_world =
      glm::dmat4(glm::transpose(glm::dmat3(right, glm::cross(forward, right), forward))) * at(-eye.x, -eye.y, -eye.z);
  return plan;
}

// A floor in the light of a lamp, seen by an eye close to it, which is turned about its axis.
std::size_t darker_edge_on(std::mt19937& random) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Floor floor{.light = {.kind = LightKind::point, .intensity = 30}};
  floor.light.shadow_px = 32u << random() % 5;
  floor.place = glm::dvec3(between(-4, 4), between(-4, 4), between(0.3, 4));
  const glm::dvec3 eye(between(-5, 5), between(-5, 5), 6 * std::pow(10, between(-4, -2)));
  const double yaw = between(0, 2 * kPi), pitch = between(-0.4, 0.2), roll = between(0, 2 * kPi);
  const FramePlan plan = edge_on(floor, eye, yaw, pitch, roll);
  const RendererScene scene = floor.scene();
  const std::vector<glm::vec4> seen = picture(scene, with_shadows(scene, plan)), lit = picture_without(scene, plan);
  std::size_t darker = 0;
  for (std::size_t p = 0; p < seen.size(); ++p) darker += seen[p] != lit[p];
  return darker;
}

TEST_CASE("no plane shades itself where the camera sees it edge-on") {
  // With interpolated positions 31 of 3,000 such views had darker pixels, three of these.
  std::mt19937 random(4);
  std::size_t darker = 0;
  for (int view = 0; view < 120; ++view) darker += darker_edge_on(random);
  CHECK(darker == 0);
}

// Two planes that meet at x = 0 and rise by these angles to the left and to the right, seen from above.
RendererScene folded(double left_deg, double right_deg, const Light& light) {
  RendererScene scene = scene_with_ambient(kAmbient);
  for (const double side : {-1.0, 1.0}) {
    const double angle = (side < 0 ? left_deg : right_deg) * kPi / 180;
    const glm::dvec3 along(side * std::cos(angle), 0, std::sin(angle)), across(0, 1, 0);
    glm::dmat4 m(glm::dmat3(along, across, glm::cross(along, across)));
    Material material = colored({1, 1, 1, 1});
    material.double_sided = true;
    scene.add(rectangle(0, -4, 4, 4), material, m);
  }
  scene.add_light(light, glm::dmat4(1));
  return scene;
}

TEST_CASE("planes that meet in a valley or on a ridge do not shade each other where light falls on both") {
  // Elevations of the light above both planes.
  const struct {
    double left_deg, right_deg, elevation_deg;
  } folds[] = {{0, 60, 100}, {45, 45, 80}, {30, 80, 95}, {-50, -20, 52}, {-60, -60, 119}, {-80, 0, 82}, {0, -40, 100}};
  for (const auto& fold : folds) {
    for (const std::uint32_t px : {64u, 200u}) {
      CAPTURE(fold.left_deg);
      CAPTURE(fold.right_deg);
      CAPTURE(px);
      const double e = fold.elevation_deg * kPi / 180;
      Light light = sun(0, 0, px);
      light.direction = glm::normalize(glm::dvec3(-std::cos(e), 0.2, -std::sin(e)));
      const RendererScene scene = folded(fold.left_deg, fold.right_deg, light);
      const FramePlan plan = Floor{}.plan();
      const std::vector<glm::vec4> seen = picture(scene, with_shadows(scene, plan)), lit = picture_without(scene, plan);
      const auto darker = std::ranges::mismatch(seen, lit).in1 - seen.begin();
      CHECK(darker == static_cast<std::ptrdiff_t>(seen.size()));
    }
  }
}

TEST_CASE("a lamp at the eye lights all visible surfaces, across the seams of its cube") {
  RendererScene scene = scene_with_ambient(kAmbient);
  Material wall = colored({1, 1, 1, 1});
  wall.double_sided = true;
  scene.add(box_mesh({8, 6, 5}), wall, at(0.3, -0.4, 0.2));
  for (const glm::dvec3& p :
       {glm::dvec3(2, 1, 0), {-2, 0.5, 1}, {0, 2, -1}, {1, -2, 0.3}, {0.2, 0, 1.5}, {0, 0.4, -1.5}}) {
    scene.add(box_mesh({0.5, 0.7, 0.3}), wall, at(p.x, p.y, p.z));
  }
  scene.add_light({.kind = LightKind::point, .intensity = 10, .shadow_px = 100}, glm::dmat4(1));
  for (int turn = 0; turn < 4; ++turn) {
    FramePlan plan = plan_of(kFloorSide_px, kFloorSide_px, kFloorSide_px / 2.0, true, true);
    const double angle = 0.3 + turn * kPi / 2;
    const glm::dvec3 forward(std::cos(angle), std::sin(angle), 0), right(std::sin(angle), -std::cos(angle), 0);
    view_of(plan).view_from_world = glm::dmat4(glm::transpose(glm::dmat3(right, glm::dvec3(0, 0, -1), forward)));
    const std::vector<glm::vec4> lit = picture_without(scene, plan);
    Renderer renderer(device());
    const FramePlan shaded = with_shadows(scene, plan);
    const PassResult result = renderer.render(scene.list, shaded)[0];
    const std::vector<glm::vec4> seen = copy(result.color);
    const std::vector<float> depth = copy(result.depth);
    // The centre of a texel may hit a surface that a pixel in it, half a texel away, does not: 0.02 / sqrt(2) of the
    // focal length in the middle of a side, three times that in the corner of a picture of 90 degrees.
    constexpr int kNear_px = 3;
    static_assert(kNear_px > 3 * 0.02 * std::numbers::sqrt2 / 2 * kFloorSide_px / 2);
    for (int y = 0; y < int{kFloorSide_px}; ++y) {
      for (int x = 0; x < int{kFloorSide_px}; ++x) {
        const auto index = [](int px, int py) {
          return static_cast<std::size_t>(py) * kFloorSide_px + static_cast<std::size_t>(px);
        };
        if (seen[index(x, y)] == lit[index(x, y)]) continue;
        bool beside_edge = false;
        for (int v = std::max(y - kNear_px, 0); v <= std::min(y + kNear_px, int{kFloorSide_px} - 1); ++v) {
          for (int u = std::max(x - kNear_px, 0); u <= std::min(x + kNear_px, int{kFloorSide_px} - 1); ++u) {
            beside_edge |= depth[index(u, v)] > 1.2f * depth[index(x, y)];  // near / z
          }
        }
        CHECK(beside_edge);
      }
    }
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
