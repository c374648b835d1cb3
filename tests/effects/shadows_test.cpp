// Shadows of masked and blended surfaces, of several lights, and when shadow maps are planned.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include <simvis/error.h>
#include "shaders/interop.h"
#include "tests/support/shadow_floor.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

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
