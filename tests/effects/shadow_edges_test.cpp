// Edges of shadows: the lit points of a floor, compared with rays cast here in double.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/shadow_floor.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

// The side of an edge is decided at the centres of square texels, and no point is farther from a centre than this, in
// texels.
constexpr double kEdge_texels = std::numbers::sqrt2 / 2;
// Where the caster stands on the surface that it shades, the centre of a texel may count as lit along the light for the
// depth of the caster's plane within the texel: the same length again.
constexpr double kContact_texels = 2 * kEdge_texels;
// The neighbourhood of a point within a radius is sampled in this many directions. A right angle that reaches between
// two of them comes no nearer than 1 - sin(pi / 16) of the radius.
constexpr int kDirections = 16;
const double kWidening = 1 / (1 - std::sin(kPi / kDirections));

// Whether the segment from `point` along `way` hits a block.
bool blocked(const std::vector<Block>& blocks, const glm::dvec3& point, const glm::dvec3& way) {
  constexpr double kStart = 1e-9;  // of the segment: beyond the rounding of a point on a block's face
  return std::ranges::any_of(blocks, [&](const Block& block) {
    double first = kStart, last = 1;
    for (int i = 0; i < 3; ++i) {
      if (way[i] == 0) {
        if (point[i] <= block.low[i] || point[i] >= block.high[i]) return false;
        continue;
      }
      const double a = (block.low[i] - point[i]) / way[i], b = (block.high[i] - point[i]) / way[i];
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
    }
    return first < last;
  });
}

constexpr double kFar_m = 1e3;

glm::dvec3 to_light(const Floor& floor, const glm::dvec3& point) {
  return floor.light.kind == LightKind::directional ? -kFar_m * floor.light.direction : floor.place - point;
}

// The point of the floor that a map sees at a place in its image.
glm::dvec3 on_floor(const Floor& floor, const View& map, const glm::dvec2& uv) {
  const glm::dmat4 world_from_map = glm::inverse(map.view_from_world);
  const glm::dvec2 xy((uv.x - map.pinhole.cx_px) / map.pinhole.fx_px, (uv.y - map.pinhole.cy_px) / map.pinhole.fy_px);
  const glm::dvec3 start(world_from_map * (map.orthographic ? glm::dvec4(xy, 0, 1) : glm::dvec4(0, 0, 0, 1)));
  const glm::dvec3 way = glm::dmat3(world_from_map) * (map.orthographic ? glm::dvec3(0, 0, 1) : glm::dvec3(xy, 1));
  const glm::dvec3 local = start - floor.origin;
  return local - way * (local.z / way.z);
}

// The side of the cube that contains a point, or the only map.
const View& map_of(const Floor& floor, const Pass& maps, const glm::dvec3& point) {
  return *std::ranges::max_element(maps.views, {}, [&](const View& map) {
    const glm::dvec4 seen = map.view_from_world * glm::dvec4(point + floor.origin, 1);
    return seen.z;
  });
}

struct Outcome {
  int lit = 0, dark = 0, near_edges = 0, wrong = 0;
  int wrong_near_edges = 0;
};

// Compares each pixel with the truth, unless the truth changes within `radius` texels.
Outcome examine(const Floor& floor, double radius_texels) {
  const RendererScene scene = floor.scene();
  const FramePlan plan = with_shadows(scene, floor.plan());
  REQUIRE(plan.passes.size() == 2);
  const std::vector<glm::vec4> seen = picture(scene, plan), bright = picture_without(scene, floor.plan());
  Outcome outcome;
  const glm::dvec3 eye(0, 0, kHeight_m);
  for (std::uint32_t y = 0; y < kFloorSide_px; ++y) {
    for (std::uint32_t x = 0; x < kFloorSide_px; ++x) {
      const double half = kFloorSide_px / 2.0;
      const glm::dvec3 point((x + 0.5 - half) / half * kHeight_m, (half - y - 0.5) / half * kHeight_m, 0);
      if (blocked(floor.blocks, eye, 1.001 * (point - eye))) continue;  // a block is visible
      const View& map = map_of(floor, plan.passes[1], point);
      const bool truth = blocked(floor.blocks, point, to_light(floor, point));
      bool near_edge = false;
      for (int d = 0; d < kDirections && !near_edge; ++d) {
        const double angle = 2 * kPi * d / kDirections, r = radius_texels * kWidening;
        const glm::dvec3 other =
            on_floor(floor, map, in_map(floor, map, point) + r * glm::dvec2(std::cos(angle), std::sin(angle)));
        near_edge = blocked(floor.blocks, other, to_light(floor, other)) != truth;
      }
      const glm::vec4 &pixel = seen[y * kFloorSide_px + x], &lit = bright[y * kFloorSide_px + x];
      // A lit pixel is equal to the bit to the picture without shadows. A shaded one shows the ambient light alone.
      const bool as_it_should = truth ? pixel.r == static_cast<float>(kAmbient) : pixel == lit;
      if (near_edge) {
        ++outcome.near_edges;
        outcome.wrong_near_edges += !as_it_should;
        continue;
      }
      ++(truth ? outcome.dark : outcome.lit);
      if (!as_it_should && outcome.wrong++ == 0) {
        MESSAGE("pixel ", x, " ", y, " is ", pixel.r, ", lit it would be ", lit.r, ", shadow ", truth);
      }
    }
  }
  return outcome;
}

void check_edges(Floor floor, double radius_texels) {
  int before = 0;
  for (const std::uint32_t px : {32u, 128u, 512u}) {
    CAPTURE(px);
    floor.light.shadow_px = px;
    const Outcome outcome = examine(floor, radius_texels);
    CHECK(outcome.wrong == 0);
    CHECK(outcome.dark + outcome.near_edges > 50);
    CHECK(outcome.lit > 1000);
    // The coarsest map is wrong somewhere. A quarter of the texel allows a quarter of the band; half is allowed because
    // the count is in pixels.
    if (px == 32) CHECK(outcome.wrong_near_edges > 0);
    if (px > 32) CHECK(outcome.near_edges < before / 2);
    before = outcome.near_edges;
  }
}

TEST_CASE("directional light: the shadow of a box ends where its rays do, within half a texel") {
  check_edges({.blocks = {kLifted}, .light = sun(30, 45)}, kEdge_texels);
  check_edges({.blocks = {kLifted}, .light = sun(-100, 70)}, kEdge_texels);
  check_edges({.blocks = {kStanding}, .light = sun(75, 35)}, kContact_texels);
}

TEST_CASE("spot light: the same, through one map or, for a wide cone, through a cube") {
  Floor floor{.blocks = {kLifted},
              .light = {.kind = LightKind::spot, .intensity = 40, .inner_cone_rad = 0.9, .outer_cone_rad = 1.0},
              .place = {-1.5, 1, 4}};
  floor.light.direction = glm::normalize(glm::dvec3(0.3, -0.2, -1));
  check_edges(floor, kEdge_texels);
  floor.light.inner_cone_rad = 1.2;
  floor.light.outer_cone_rad = 1.3;
  check_edges(floor, kEdge_texels);
  floor.blocks = {kStanding};
  check_edges(floor, kContact_texels);
}

TEST_CASE("point light: the same, in all directions") {
  check_edges({.blocks = {kLifted, {{2, -3, 0.3}, {3, 2, 0.9}}, {{-4, -4, 1}, {-3, -2, 1.5}}},
               .light = {.kind = LightKind::point, .intensity = 30},
               .place = {0.3, -0.2, 2}},
              kEdge_texels);
}

TEST_CASE("shadows far from the origin are the same as near it") {
  // Places there have a resolution of 2e-9 m.
  for (const glm::dvec3& origin : {glm::dvec3(1e7, -1e7, 0), glm::dvec3(-3e6, 2e5, 1e7)}) {
    for (Floor floor : {Floor{.blocks = {kStanding}, .light = sun(75, 35)},
                        Floor{.blocks = {kStanding},
                        .light = {.kind = LightKind::point, .intensity = 30, .shadow_px = 256},
                        .place = {-3, 2, 3}}}) {
      floor.origin = origin;
      CHECK(examine(floor, kContact_texels).wrong == 0);
    }
  }
}

TEST_CASE("objects outside the picture cast their shadows into it") {
  const Floor floor{.blocks = {{{7, -1, 0}, {8, 1, 6}}}, .light = sun(0, 30)};
  const Outcome outcome = examine(floor, kContact_texels);
  CHECK(outcome.wrong == 0);
  CHECK(outcome.dark > 500);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
