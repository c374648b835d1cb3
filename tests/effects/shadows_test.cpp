// Shadows of lights: the lit points of a floor, compared with rays cast here in double.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <simvis/error.h>
#include "effects/scene/shadows.h"
#include "scenegraph/primitive_meshes.h"
#include "shaders/interop.h"
#include "tests/support/reference_directions.h"
#include "tests/support/renderer_scene.h"

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

constexpr double kAmbient = 0.25;
constexpr std::uint32_t kFloorSide_px = 128;
constexpr double kHeight_m = 6;

struct Block {
  glm::dvec3 low, high;
};

// The floor z = 0 with blocks on or above it, lit by one light and seen from straight above, at `origin` of the world.
struct Floor {
  std::vector<Block> blocks{};
  Light light{};
  glm::dvec3 place{0};   // of the light
  glm::dvec3 origin{0};  // the rest is relative to it
  std::uint32_t supersampling = 1, msaa = 1;

  RendererScene scene() const {
    RendererScene made = scene_with_ambient(kAmbient);
    glm::dmat4 upwards(1);
    upwards[1][1] = upwards[2][2] = -1;
    upwards[3] = glm::dvec4(origin, 1);
    made.add(rectangle(-6, -6, 6, 6), colored({1, 1, 1, 1}), upwards);
    for (const Block& block : blocks) {
      const glm::dvec3 middle = origin + (block.low + block.high) * 0.5;
      made.add(box_mesh(block.high - block.low), colored({1, 1, 1, 1}), at(middle.x, middle.y, middle.z));
    }
    made.add_light(light, at(origin.x + place.x, origin.y + place.y, origin.z + place.z));
    return made;
  }
  FramePlan plan() const {
    FramePlan made = plan_of(kFloorSide_px, kFloorSide_px, kFloorSide_px / 2.0, true, false);
    made.passes[0].supersampling = supersampling;
    made.passes[0].msaa = msaa;
    glm::dmat4 down(1);
    down[1][1] = down[2][2] = -1;
    view_of(made).view_from_world = down * at(-origin.x, -origin.y, -origin.z - kHeight_m);
    return made;
  }
};

FramePlan with_shadows(const RendererScene& scene, FramePlan plan) {
  plan_shadows(scene.list, device().target_limits(), plan);
  return plan;
}

std::vector<glm::vec4> picture(const RendererScene& scene, const FramePlan& plan) {
  static Renderer renderer(device());
  return copy(renderer.render(scene.list, plan)[0].color);
}

std::vector<glm::vec4> picture_without(RendererScene scene, const FramePlan& plan) {
  for (LightItem& item : scene.list.lights) item.light.shadow_px = 0;
  return picture(scene, plan);
}

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

glm::dvec2 in_map(const Floor& floor, const View& map, const glm::dvec3& point) {
  const glm::dvec3 p(map.view_from_world * glm::dvec4(point + floor.origin, 1));
  const double w = map.orthographic ? 1 : p.z;
  return {map.pinhole.cx_px + map.pinhole.fx_px * p.x / w, map.pinhole.cy_px + map.pinhole.fy_px * p.y / w};
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

Light sun(double azimuth_deg, double elevation_deg, std::uint32_t px = 256) {
  const double a = azimuth_deg * kPi / 180, e = elevation_deg * kPi / 180;
  return {.kind = LightKind::directional,
          .intensity = 3,
          .direction = {-std::cos(e) * std::cos(a), -std::cos(e) * std::sin(a), -std::sin(e)},
          .shadow_px = px};
}

const Block kLifted{{-1, -0.7, 0.5}, {0.6, 0.9, 1.3}}, kStanding{{-1, -0.7, 0}, {0.6, 0.9, 1.1}};

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

// A plate of this material above the floor in steep light: the dark share of its shadow's square.
std::vector<bool> shadow_of(const Material& material) {
  Floor floor{.light = sun(0, 60, 512)};
  RendererScene scene = floor.scene();
  scene.add(rectangle(-1, -1, 1, 1), material, at(0, 0, 1));
  const std::vector<glm::vec4> seen = picture(scene, with_shadows(scene, floor.plan()));
  // The centres of the texture's four columns, projected along the light over the height of the plate.
  std::vector<bool> dark;
  for (int column = 0; column < 4; ++column) {
    const double x = -0.75 + 0.5 * column - 1 / std::tan(60 * kPi / 180), y = -0.9;
    const double half = kFloorSide_px / 2.0;
    const auto px = static_cast<std::size_t>(half + x / kHeight_m * half),
               py = static_cast<std::size_t>(half - y / kHeight_m * half);
    dark.push_back(seen[py * kFloorSide_px + px].r == static_cast<float>(kAmbient));
  }
  return dark;
}

TEST_CASE("masked surfaces cast shadows with holes, blended ones cast a shadow from half coverage on") {
  using Dark = std::vector<bool>;
  Material plate = colored({1, 1, 1, 1});
  CHECK(shadow_of(plate) == Dark{true, true, true, true});
  plate.base_color_texture = four_texels();  // alpha 0, 100, 200, 255
  plate.alpha_mode = AlphaMode::mask;
  CHECK(shadow_of(plate) == Dark{false, false, true, true});
  plate.alpha_cutoff = 0.9f;
  CHECK(shadow_of(plate) == Dark{false, false, false, true});
  plate.alpha_mode = AlphaMode::blend;
  CHECK(shadow_of(plate) == Dark{false, false, true, true});
  plate.opacity = 0.6f;  // 200 / 255 * 0.6 is less than half
  CHECK(shadow_of(plate) == Dark{false, false, false, true});
  plate.opacity = 0.4f;
  CHECK(shadow_of(plate) == Dark{false, false, false, false});
}

TEST_CASE("the order of lights and items does not matter, and multisampled pixels show shadows too") {
  Floor floor{.blocks = {kStanding, {{2, -3, 0.3}, {3, 2, 0.9}}}, .light = sun(75, 35)};
  RendererScene scene = floor.scene();
  scene.add_light({.kind = LightKind::point, .intensity = 30, .shadow_px = 128}, at(-2, 3, 3));
  const std::vector<glm::vec4> seen = picture(scene, with_shadows(scene, floor.plan()));
  RendererScene reversed = scene;
  std::ranges::reverse(reversed.list.lights);
  std::ranges::reverse(reversed.list.items);
  const std::vector<glm::vec4> again = picture(reversed, with_shadows(reversed, floor.plan()));
  CHECK(same_bytes(std::span<const glm::vec4>(seen), {again}));

  floor.supersampling = 2;
  floor.msaa = device().target_limits().msaa.back();
  const std::vector<glm::vec4> mean = picture(scene, with_shadows(scene, floor.plan()));
  // The mean of sixteen samples adds rounding. Only pixels that contain an edge differ by more.
  constexpr float kRounding = 1e-5f;
  const auto apart = [&](std::size_t i) { return std::abs(mean[i].r - seen[i].r) > kRounding + 0.02f * seen[i].r; };
  std::size_t edges = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) edges += apart(i);
  CHECK(edges > 0);
  CHECK(edges < seen.size() / 20);
}

TEST_CASE("the texels of a directional light are fixed in the world while the camera moves") {
  const Floor floor{.blocks = {kStanding}, .light = sun(75, 35)};
  const RendererScene scene = floor.scene();
  FramePlan here = floor.plan(), there = floor.plan();
  view_of(there).view_from_world = view_of(here).view_from_world * at(0.123, -0.077, 0.05);
  here = with_shadows(scene, here);
  there = with_shadows(scene, there);
  const View &a = here.passes[1].views[0], &b = there.passes[1].views[0];
  REQUIRE(a.pinhole.fx_px == b.pinhole.fx_px);
  const glm::dvec2 moved = in_map(floor, a, {0.3, 0.4, 0}) - in_map(floor, b, {0.3, 0.4, 0});
  constexpr double kRounding_texels = 1e-9;
  CHECK(std::abs(moved.x - std::round(moved.x)) < kRounding_texels);
  CHECK(std::abs(moved.y - std::round(moved.y)) < kRounding_texels);
}

TEST_CASE("shadow maps are planned only where a colour output shows surfaces that lights reach") {
  Floor floor{.blocks = {kStanding}, .light = sun(75, 35, 64)};
  const RendererScene scene = floor.scene();
  FramePlan plan = with_shadows(scene, floor.plan());
  REQUIRE(plan.passes.size() == 2);
  CHECK(plan.passes[1].shadow_maps);
  CHECK(plan.passes[1].width_px == 64);
  CHECK(plan.passes[1].views[0].reason == "what it casts in view of pass");
  REQUIRE(plan.effects.size() == 1);
  CHECK(plan.effects[0].effect == "shadows");
  CHECK(view_of(plan).shadows.size() == 1);

  const auto unplanned = [](const RendererScene& unshaded, const FramePlan& asked) {
    const FramePlan made = with_shadows(unshaded, asked);
    return made.passes.size() == 1 && made.effects.empty() && made.passes[0].views[0].shadows.empty();
  };
  FramePlan depth = floor.plan();
  depth.passes[0].color = false;
  depth.passes[0].depth = true;
  CHECK(unplanned(scene, depth));
  RendererScene dark = scene, unlit = scene, away = scene, without = scene;
  dark.list.lights[0].light.intensity = 0;
  CHECK(unplanned(dark, floor.plan()));
  unlit.list.materials.clear();
  for (std::size_t i = 0; i < scene.list.materials.size(); ++i) {
    Material material = *scene.list.materials[i];
    material.unlit = true;
    unlit.list.materials.push_back(std::make_shared<const Material>(material));
  }
  CHECK(unplanned(unlit, floor.plan()));
  away.list.lights[0].light = {.kind = LightKind::point, .range_m = 2, .shadow_px = 64};
  away.list.world_from_node[away.list.lights[0].transform] = at(0, 0, 20);
  CHECK(unplanned(away, floor.plan()));
  without.list.lights[0].light.shadow_px = 0;
  CHECK(unplanned(without, floor.plan()));
}

TEST_CASE("too many or too large shadow maps are refused with the limit") {
  Floor floor{.light = {.kind = LightKind::point, .intensity = 1, .shadow_px = 16}, .place = {0, 0, 3}};
  RendererScene scene = floor.scene();
  while (scene.list.lights.size() <= SIMVIS_MAX_SHADOWS) scene.list.lights.push_back(scene.list.lights[0]);
  CHECK_THROWS_WITH_AS(with_shadows(scene, floor.plan()),
                       "view \"view\" shows shadows of 65 lights, expected at most 64", InputError);
  scene.list.lights.pop_back();
  CHECK(picture(scene, with_shadows(scene, floor.plan())).size() == kFloorSide_px * kFloorSide_px);
  for (LightItem& item : scene.list.lights) item.light.shadow_px = 8192;
  CHECK_THROWS_AS(with_shadows(scene, floor.plan()), InputError);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
