// Lights of a kind that differ only in their position share a part of their shading.
#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("engine");

namespace simvis::test {
namespace {

// The sums are made in another order: some roundings of float32, 6e-8 each, of sums of equal signs.
constexpr double kOrderOfSums = 1e-6;  // relative

constexpr std::size_t kMiddle = 8 * 16 + 8;  // a pixel that every lamp lights, of a picture of 16 x 16

RendererScene wall_and_lamps(const Light& lamp, std::vector<glm::dvec3> places) {
  RendererScene scene = scene_with_ambient(0);
  Material glossy = colored({0.8f, 0.5f, 0.3f, 1});
  glossy.roughness = 0.4f;
  glossy.metallic = 0.5f;
  scene.add(rectangle(-5, -5, 5, 5), glossy, at(0, 0, 3));
  for (const glm::dvec3& place : places) scene.add_light(lamp, at(place.x, place.y, place.z));
  return scene;
}

TEST_CASE("lights that differ only in position light a surface as each of them alone does") {
  const FramePlan plan = plan_of(16, 16, 8, true, false);
  const std::vector<glm::dvec3> places = {{-1, 0, 0.5}, {0.5, 0.25, 1}, {1, -1, 0}};
  const Light lamps[] = {{.kind = LightKind::point, .color = {1, 0.5f, 0.25f}, .intensity = 4, .range_m = 6},
                         {.kind = LightKind::spot,
                          .color = {1, 0.5f, 0.25f},
                          .intensity = 4,
                          .inner_cone_rad = 0.3,
                          .outer_cone_rad = 0.9,
                          .direction = {0, 0, 1}}};
  for (const Light& lamp : lamps) {
    std::vector<glm::vec3> sum(16 * 16, glm::vec3(0));
    for (const glm::dvec3& place : places) {
      Renderer renderer(device());
      const RendererScene alone = wall_and_lamps(lamp, {place});
      const auto color = renderer.render(alone.list, plan)[0].color;
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += glm::vec3(color[i]);
    }
    Renderer renderer(device());
    RendererScene all = wall_and_lamps(lamp, places);
    const auto color = renderer.render(all.list, plan)[0].color;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      for (int channel = 0; channel < 3; ++channel) {
        CHECK(color[i][channel] == doctest::Approx(sum[i][channel]).epsilon(kOrderOfSums));
      }
    }
    CHECK(sum[kMiddle].g > 0);

    // With another intensity, the second lamp adds what it alone adds once more.
    all.list.lights[1].light.intensity *= 2;
    const glm::vec4 before = color[kMiddle], after = renderer.render(all.list, plan)[0].color[kMiddle];
    Renderer other(device());
    const RendererScene second = wall_and_lamps(lamp, {places[1]});
    const glm::vec4 added = other.render(second.list, plan)[0].color[kMiddle];
    CHECK(after.r == doctest::Approx(before.r + added.r).epsilon(kOrderOfSums));
  }
}

TEST_CASE("lights that flicker make pipelines once") {
  const FramePlan plan = plan_of(8, 8, 4, true, false);
  RendererScene scene = wall_and_lamps({.kind = LightKind::point}, {{-1, 0, 0}, {1, 0, 0}});
  Renderer renderer(device());
  renderer.render(scene.list, plan);
  renderer.render(scene.list, plan);
  CHECK(renderer.counters().pipelines_made == 0);
  scene.list.lights[1].light.intensity = 3;
  renderer.render(scene.list, plan);
  CHECK(renderer.counters().pipelines_made == 1);
  for (const double intensity : {1.0, 2.0, 1.0}) {
    scene.list.lights[1].light.intensity = intensity;
    renderer.render(scene.list, plan);
    CHECK(renderer.counters().pipelines_made == 0);
    CHECK(renderer.counters().pipelines_bound == 1);
  }
}

TEST_CASE("a picture depends on its own lights, and not on those of earlier frames") {
  const FramePlan plan = plan_of(16, 16, 8, true, false);
  RendererScene scene =
      wall_and_lamps({.kind = LightKind::point, .color = {1, 0.7f, 0.3f}}, {{-1, 0, 0.3}, {1, 0.4, 0}, {0.2, -1, 0.7}});
  Renderer fresh(device());
  const auto expected = fresh.render(scene.list, plan)[0].color;
  Renderer renderer(device());
  scene.list.lights[1].light.intensity = 3;
  renderer.render(scene.list, plan);
  scene.list.lights[1].light.intensity = scene.list.lights[0].light.intensity;
  const auto color = renderer.render(scene.list, plan)[0].color;
  REQUIRE(color.size() == expected.size());
  CHECK(std::memcmp(color.data(), expected.data(), color.size() * sizeof(color[0])) == 0);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
