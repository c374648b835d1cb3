// Fog in pictures against Koschmieder's law, computed per pixel in double.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include <simvis/effect.h>
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("effects");

using namespace simvis;
using namespace simvis::test;

namespace {

constexpr double kHalfUlp = 0x1p-24;  // of float32, relative

// Relative error of t = exp(-x). Vulkan allows exp() 3 + 2 x ulps. The argument is the product of two rounded numbers;
// the distance comes from a position that is interpolated with perspective and from a square root: 16 half ulps cover
// these.
double transmittance_error(double x) { return (2 * (3 + 2 * x) + 18 * x) * kHalfUlp; }

// Error of surface t + airlight (1 - t): that error, two roundings for each of the two products and one for the sum.
double fog_error(double surface, double airlight, double x) {
  const double t = std::exp(-x);
  return (surface + airlight) * t * transmittance_error(x) + 3 * (surface + airlight) * kHalfUlp;
}

constexpr std::uint32_t kSize = 24;
constexpr double kFogFocal_px = 12;
const glm::vec3 kAirlight{0.7f, 0.5f, 0.9f};

FramePlan square_plan(bool color, bool depth) { return plan_of(kSize, kSize, kFogFocal_px, color, depth); }

RendererScene foggy(double extinction_per_m) {
  RendererScene scene = scene_with_ambient(0.5);
  scene.list.medium.extinction_per_m = extinction_per_m;
  scene.list.medium.airlight = kAirlight;
  return scene;
}

Material unlit(const glm::vec4& color) {
  Material material = colored(color);
  material.unlit = true;
  return material;
}

/// Distance from the eye to the plane at this depth, through the pixel.
double distance_m(std::uint32_t pixel, double depth_m) {
  const double x = (pixel % kSize + 0.5 - kSize / 2.0) / kFogFocal_px,
               y = (pixel / kSize + 0.5 - kSize / 2.0) / kFogFocal_px;
  return depth_m * std::sqrt(x * x + y * y + 1);
}

const Mesh kWall = rectangle(-5000, -5000, 5000, 5000);

}  // namespace

TEST_CASE("radiance falls exponentially along the ray and is replaced by that of the air") {
  Renderer renderer(device());
  const glm::vec4 color{0.8f, 0.1f, 0.3f, 1};
  for (const double extinction : {0.003, 0.05, 0.4}) {
    for (const double depth : {0.5, 3.0, 20.0, 150.0}) {
      CAPTURE(extinction);
      CAPTURE(depth);
      RendererScene scene = foggy(extinction);
      scene.add(kWall, unlit(color), at(0, 0, depth));
      const std::vector<glm::vec4> seen = copy(renderer.render(scene.list, square_plan(true, false))[0].color);
      int wrong = 0;
      for (std::uint32_t i = 0; i < seen.size(); ++i) {
        const double x = extinction * distance_m(i, depth), t = std::exp(-x);
        for (int c = 0; c < 3; ++c) {
          const double expected = color[c] * t + kAirlight[c] * (1 - t);
          wrong += std::abs(seen[i][c] - expected) > fog_error(color[c], kAirlight[c], x);
        }
      }
      CHECK(wrong == 0);
    }
  }
}

TEST_CASE("fog weakens lit surfaces and emission alike; the background is the airlight") {
  Renderer renderer(device());
  constexpr double kDepth_m = 7, kExtinction = 0.1;
  RendererScene scene = foggy(kExtinction), clear = scene_with_ambient(0.5);
  Material material = colored({0.8f, 0.1f, 0.3f, 1});
  material.emissive = {0.5f, 0.25f, 0};
  for (RendererScene* each : {&scene, &clear}) {
    each->add(rectangle(-5, -5, 0, 5), material, at(0, 0, kDepth_m));
    each->add_light({.kind = LightKind::point, .intensity = 60}, at(1, 1, 2));
  }
  const std::vector<glm::vec4> in_fog = copy(renderer.render(scene.list, square_plan(true, false))[0].color);
  const std::vector<glm::vec4> in_air = copy(renderer.render(clear.list, square_plan(true, false))[0].color);
  const std::uint32_t left = kSize * 12 + 6, right = kSize * 12 + 18;
  const double x = kExtinction * distance_m(left, kDepth_m), t = std::exp(-x);
  for (int c = 0; c < 3; ++c) {
    CHECK(std::abs(in_fog[left][c] - (in_air[left][c] * t + kAirlight[c] * (1 - t))) <
          fog_error(in_air[left][c], kAirlight[c], x));
  }
  CHECK(in_air[right] == glm::vec4(kBackground, kBackground, kBackground, 1));
  CHECK(in_fog[right] == glm::vec4(kAirlight, 1));
}

TEST_CASE("light of transparent surfaces passes through the fog in front of each of them") {
  Renderer renderer(device());
  constexpr double kExtinction = 0.15;
  struct Layer {
    double depth_m;
    float grey, alpha;
  };
  constexpr Layer kLayers[] = {{12, 0.9f, 0.75f}, {6, 0.1f, 0.5f}, {2, 0.4f, 0.25f}};
  RendererScene scene = foggy(kExtinction);
  for (const Layer& layer : kLayers) {
    Material material = unlit({layer.grey, layer.grey, layer.grey, layer.alpha});
    material.alpha_mode = AlphaMode::blend;
    scene.add(kWall, material, at(0, 0, layer.depth_m));
  }
  const std::vector<glm::vec4> seen = copy(renderer.render(scene.list, square_plan(true, false))[0].color);
  int wrong = 0;
  for (std::uint32_t i = 0; i < seen.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      double expected = kAirlight[c], error = 8 * kHalfUlp;
      for (const Layer& layer : kLayers) {
        const double x = kExtinction * distance_m(i, layer.depth_m), t = std::exp(-x);
        expected = layer.alpha * (layer.grey * t + kAirlight[c] * (1 - t)) + (1 - layer.alpha) * expected;
        error += fog_error(layer.grey, kAirlight[c], x) + 5 * kHalfUlp;
      }
      wrong += std::abs(seen[i][c] - expected) > error;
    }
  }
  CHECK(wrong == 0);
}

TEST_CASE("depth is not changed by fog, and clear air leaves every byte and counter unchanged") {
  const auto frame = [](const RendererScene& scene, const FramePlan& plan) {
    Renderer renderer(device());
    const PassResult& result = renderer.render(scene.list, plan)[0];
    return std::tuple(copy(result.color), copy(result.depth), renderer.counters());
  };
  RendererScene fog = foggy(0.2), clear = foggy(0), plain = scene_with_ambient(0.5);
  plain.list.medium = {};
  for (RendererScene* scene : {&fog, &clear, &plain}) {
    scene->add(rectangle(-5, -5, 0, 5), colored({0.8f, 0.1f, 0.3f, 1}), at(0, 0, 4));
    Material glass = colored({0.2f, 0.3f, 0.4f, 0.75f});
    glass.alpha_mode = AlphaMode::blend;
    scene->add(rectangle(-1, -5, 3, 5), glass, at(0, 0, 3));
  }
  CHECK(frame(clear, square_plan(true, true)) == frame(plain, square_plan(true, true)));
  CHECK(frame(fog, square_plan(false, true)) == frame(plain, square_plan(false, true)));
  const auto in_fog = frame(fog, square_plan(true, true)), without = frame(plain, square_plan(true, true));
  CHECK(std::get<0>(in_fog) != std::get<0>(without));
  CHECK(std::get<1>(in_fog) == std::get<1>(without));
}

TEST_CASE("the catalogue names the caller of the effect") {
  const EffectType* const fog = find_effect_type("fog");
  REQUIRE(fog != nullptr);
  CHECK(fog->outputs == kShownInColor);
  CHECK(fog->in_scene(foggy(0.01).list));
  CHECK_FALSE(fog->in_scene(foggy(0).list));
}

TEST_SUITE_END();
