#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include <simvis/error.h>
#include "shaders/interop.h"
#include "tests/support/reference_directions.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;
using namespace simvis::test;

namespace {

// Normals are stored in 16 bits (1.5e-5 in each direction). The rest is several dozen float32 operations of 6e-8 each.
constexpr double kShading = 4e-5;  // relative
// Colours of vertices are stored in 16 bits.
constexpr double kVertexColor = 1.0 / 65535;
// The driver may decode sRGB by a table or a polynomial: an error of at most half a step of 8 bits in linear light.
constexpr double kTexel = 0.5 / 255;
glm::vec4 middle(Renderer& renderer, const RendererScene& scene, FramePlan plan = plan_of(17, 17, 8, true, false)) {
  const std::uint32_t width = plan.passes[0].width_px, height = plan.passes[0].height_px;
  return renderer.render(scene.list, plan)[0].color[height / 2 * width + width / 2];
}

double linear(int srgb) {
  const double s = srgb / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

}  // namespace

TEST_CASE("background, ambient light, emission and unlit surfaces") {
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(0.5);
  CHECK(middle(renderer, scene) == glm::vec4(kBackground, kBackground, kBackground, 1));
  Material material = colored({0.8f, 0.4f, 0.2f, 1});
  material.emissive = {0.1f, 0.2f, 3.0f};
  scene.add(rectangle(-5, -5, 5, 5), material, at(0, 0, 2));
  glm::vec4 seen = middle(renderer, scene);
  CHECK(seen.r == doctest::Approx(0.5 * 0.8 + 0.1).epsilon(kShading));
  CHECK(seen.g == doctest::Approx(0.5 * 0.4 + 0.2).epsilon(kShading));
  CHECK(seen.b == doctest::Approx(0.5 * 0.2 + 3.0).epsilon(kShading));
  CHECK(seen.a == 1);
  material.unlit = true;
  RendererScene bright = scene_with_ambient(0.5);
  bright.add(rectangle(-5, -5, 5, 5), material, at(0, 0, 2));
  bright.add_light({.kind = LightKind::directional, .intensity = 100, .direction = {0, 0, 1}}, glm::dmat4(1));
  CHECK(middle(renderer, bright) == glm::vec4(0.8f, 0.4f, 0.2f, 1));
}

TEST_CASE("a directional light follows Lambert's law in its own frame") {
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(0.125);
  scene.add(rectangle(-5, -5, 5, 5), colored({0.5f, 0.5f, 0.5f, 1}), at(0, 0, 2));
  const double tilt = 0.6;
  // Rotated about y, a light along z hits the wall at an angle.
  const glm::dmat4 turned = glm::rotate(glm::dmat4(1), tilt, glm::dvec3(0, 1, 0));
  scene.add_light({.kind = LightKind::directional, .color = {1, 0.5f, 0}, .intensity = 3, .direction = {0, 0, 1}},
                  turned);
  const glm::vec4 seen = middle(renderer, scene);
  const double lit = 0.5 / kPi * 3 * std::cos(tilt);
  CHECK(seen.r == doctest::Approx(0.0625 + lit).epsilon(kShading));
  CHECK(seen.g == doctest::Approx(0.0625 + lit / 2).epsilon(kShading));
  CHECK(seen.b == doctest::Approx(0.0625).epsilon(kShading));
  // From behind it has no effect.
  scene.list.lights[0].light.direction = {0, 0, -1};
  CHECK(middle(renderer, scene).r == doctest::Approx(0.0625).epsilon(kShading));
}

TEST_CASE("a point light falls off with the square of the distance and ends at its range") {
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(0);
  scene.add(rectangle(-5, -5, 5, 5), colored({0.5f, 0.5f, 0.5f, 1}), at(0, 0, 3));
  const glm::dvec3 place(1, 0.5, 1), to_light = place - glm::dvec3(0, 0, 3);
  const double d = glm::length(to_light), cosine = 2 / d;
  scene.add_light({.kind = LightKind::point, .intensity = 7}, at(place.x, place.y, place.z));
  const double lit = 0.5 / kPi * 7 * cosine / (d * d);
  CHECK(middle(renderer, scene).r == doctest::Approx(lit).epsilon(kShading));
  scene.list.lights[0].light.range_m = 3;
  CHECK(middle(renderer, scene).r == doctest::Approx(lit * (1 - std::pow(d / 3, 4))).epsilon(4 * kShading));
  scene.list.lights[0].light.range_m = 2;
  CHECK(middle(renderer, scene).r == 0);
}

TEST_CASE("a spot light fades between its cones") {
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(0);
  scene.add(rectangle(-5, -5, 5, 5), colored({1, 1, 1, 1}), at(0, 0, 3));
  // From (0, 0, 1) to the centre of the wall; the axis is rotated away by `away`.
  const auto seen = [&](double away) {
    scene.list.lights.clear();
    scene.add_light({.kind = LightKind::spot,
                     .intensity = 2,
                     .inner_cone_rad = 0.2,
                     .outer_cone_rad = 0.5,
                     .direction = {std::sin(away), 0, std::cos(away)}},
                    at(0, 0, 1));
    return middle(renderer, scene).r;
  };
  const double full = 2 / kPi / 4;
  CHECK(seen(0.1) == doctest::Approx(full).epsilon(kShading));
  CHECK(seen(0.6) == 0);
  const double ramp = (std::cos(0.4) - std::cos(0.5)) / (std::cos(0.2) - std::cos(0.5));
  // The ramp is a difference of cosines, 0.1 wide: rounding counts ten times.
  CHECK(seen(0.4) == doctest::Approx(full * ramp * ramp).epsilon(10 * kShading));
}

TEST_CASE("many lights add up, in any number of views") {
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(0);
  scene.add(rectangle(-5, -5, 5, 5), colored({1, 1, 1, 1}), at(0, 0, 2));
  for (int i = 0; i < 100; ++i) {
    scene.add_light({.kind = LightKind::directional, .intensity = 0.5, .direction = {0, 0, 1}}, glm::dmat4(1));
  }
  FramePlan plan = plan_of(8, 4, 2, true, false);
  view_of(plan).width_px = 4;
  View other = view_of(plan);
  other.x_px = 4;
  // This view looks from the side at an angle: a Lambertian surface is equally bright.
  other.view_from_world = glm::inverse(glm::rotate(at(-1, 0, 0), 0.5, glm::dvec3(0, 1, 0)));
  plan.passes[0].views.push_back(other);
  const auto color = renderer.render(scene.list, plan)[0].color;
  CHECK(color[2 * 8 + 1].r == doctest::Approx(50 / kPi).epsilon(kShading));
  CHECK(color[2 * 8 + 6].r == doctest::Approx(50 / kPi).epsilon(kShading));
}

TEST_CASE("more lights than a view supports are refused, with their number and the limit") {
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(0);
  scene.add(rectangle(-5, -5, 5, 5), colored({1, 1, 1, 1}), at(0, 0, 2));
  for (int i = 0; i < SIMVIS_MAX_LIGHTS + 1; ++i) {
    scene.add_light({.kind = LightKind::directional, .direction = {0, 0, 1}}, glm::dmat4(1));
  }
  CHECK_THROWS_WITH_AS(renderer.render(scene.list, plan_of(4, 4, 2, true, false)),
                       "the scene has 257 lights, expected at most 256", InputError);
  scene.list.lights.pop_back();
  renderer.render(scene.list, plan_of(4, 4, 2, true, false));
  CHECK(renderer.counters().draws == 1);
}

TEST_CASE("normals are correct under mirrored and non-uniform scale, and face the viewer on back faces") {
  Renderer renderer(device());
  for (const double sx : {2.0, -2.0}) {
    for (const bool back : {false, true}) {
      CAPTURE(sx);
      CAPTURE(back);
      RendererScene scene = scene_with_ambient(0);
      Material material = colored({1, 1, 1, 1});
      material.double_sided = true;
      // The wall is tilted in its own frame, then stretched: its normal is not transformed like its points.
      glm::dmat4 m = glm::scale(at(0, 0, 4), glm::dvec3(sx, 1, 1));
      m = glm::rotate(m, back ? kPi - 0.7 : 0.7, glm::dvec3(0, 1, 0));
      scene.add(rectangle(-3, -3, 3, 3), material, m);
      scene.add_light({.kind = LightKind::directional, .intensity = kPi, .direction = {0, 0, 1}}, glm::dmat4(1));
      const glm::dvec3 n = glm::normalize(glm::transpose(glm::inverse(glm::dmat3(m))) * glm::dvec3(0, 0, -1));
      CHECK((n.z > 0) == back);
      CHECK(middle(renderer, scene).r == doctest::Approx(std::abs(n.z)).epsilon(kShading));
    }
  }
}

TEST_CASE("vertex colours multiply the base colour and are clamped to 1") {
  Renderer renderer(device());
  Mesh mesh = rectangle(-5, -5, 5, 5);
  for (VertexAttributes& a : mesh.attributes) a.color = {0.5f, 0.25f, 4.0f, 1};
  RendererScene scene = scene_with_ambient(1);
  scene.add(mesh, colored({0.5f, 1, 1, 1}), at(0, 0, 2));
  const glm::vec4 seen = middle(renderer, scene);
  CHECK(std::abs(seen.r - 0.25) <= kVertexColor);
  CHECK(std::abs(seen.g - 0.25) <= kVertexColor);
  CHECK(std::abs(seen.b - 1.0) <= kVertexColor);
}

TEST_CASE("textures are decoded from sRGB and sampled at uv") {
  Renderer renderer(device());
  Material material;
  material.base_color_texture = four_texels();
  const auto columns = [&](const Material& m) {
    const RendererScene scene = textured_wall(m);
    const auto color = renderer.render(scene.list, wall_plan(true, false))[0].color;
    return std::array<float, 4>{color[0].r, color[5].r, color[10].r, color[15].r};
  };
  const auto expect = [&](const Material& m, std::array<int, 4> texels) {
    const std::array<float, 4> seen = columns(m);
    for (int i = 0; i < 4; ++i) {
      CAPTURE(i);
      CHECK(std::abs(seen[i] - linear(kGrey[texels[i]])) <= kTexel);
    }
  };
  expect(material, {0, 1, 2, 3});
  material.uv_transform = glm::mat3x2(-1, 0, 0, 1, 1, 0);  // u -> 1 - u
  expect(material, {3, 2, 1, 0});
  material.uv_transform = glm::mat3x2(1, 0, 0, 1, 0.5f, 0);
  expect(material, {2, 3, 0, 1});
  auto mirrored = four_texels();
  mirrored->sampler.wrap_u = Wrap::mirrored_repeat;
  material.base_color_texture = mirrored;
  expect(material, {2, 3, 3, 2});
  auto clamped = four_texels();
  clamped->sampler.wrap_u = Wrap::clamp_to_edge;
  material.base_color_texture = clamped;
  expect(material, {2, 3, 3, 3});
}

TEST_CASE("the second set of texture coordinates is used when the material says so") {
  Renderer renderer(device());
  Mesh mesh = rectangle(-1, -1, 1, 1);
  for (VertexAttributes& a : mesh.attributes) a.uv[0] = {0.9f, 0.5f};
  for (const int set : {0, 1}) {
    Material material;
    material.base_color_texture = four_texels();
    material.uv_set = set;
    RendererScene scene = scene_with_ambient(1);
    scene.add(mesh, material, at(0, 0, 1));
    const auto color = renderer.render(scene.list, wall_plan(true, false))[0].color;
    CHECK(std::abs(color[0].r - linear(kGrey[set == 0 ? 3 : 0])) <= kTexel);
  }
}

TEST_CASE("a distant mipmapped texture shows its mean, one without mipmaps shows single texels") {
  Renderer renderer(device());
  auto board = std::make_shared<Texture>();
  board->name = "chessboard";
  board->width = board->height = 64;
  for (int i = 0; i < 64 * 64; ++i) {
    const std::uint8_t level = (i % 64 + i / 64) % 2 ? 255 : 0;
    board->rgba.insert(board->rgba.end(), {level, level, level, 255});
  }
  const auto seen = [&](bool mipmapped) {
    auto texture = std::make_shared<Texture>(*board);
    texture->sampler = {
        .magnify = Filter::nearest, .minify = Filter::nearest, .between_mips = Filter::nearest, .mipmapped = mipmapped};
    Material material;
    material.base_color_texture = texture;
    const RendererScene scene = textured_wall(material);
    return renderer.render(scene.list, wall_plan(true, false))[0].color[5].r;
  };
  // The mean is taken in linear light; each of the levels rounds to 8 bits of sRGB, half a step of 1/255 there, which
  // is at most 2.3 times as much in linear light.
  CHECK(std::abs(seen(true) - 0.5) <= 6 * 2.3 * 0.5 / 255);
  const float single = seen(false);
  CHECK((single < 0.01f || single > 0.99f));
}

TEST_CASE("masked texels below the cutoff are holes, in colour and in depth") {
  Renderer renderer(device());
  Material material;
  material.alpha_mode = AlphaMode::mask;
  material.alpha_cutoff = 0.5f;
  material.base_color_texture = four_texels();  // alpha 0, 0.39, 0.78, 1
  const RendererScene scene = textured_wall(material);
  for (const bool color : {false, true}) {
    const PassResult result = renderer.render(scene.list, wall_plan(color, true))[0];
    for (int x = 0; x < 4; ++x) {
      CAPTURE(x);
      CHECK((result.depth[4 + x] > 0) == (x >= 2));
      if (color) CHECK((result.color[4 + x].r != kBackground) == (x >= 2));
    }
  }
}

TEST_CASE("without a texture, the alpha of material and vertices decides what a mask keeps") {
  Renderer renderer(device());
  Mesh mesh = rectangle(-1, -1, 1, 1);
  for (VertexAttributes& a : mesh.attributes) a.color.a = 0.5f;
  for (const float alpha : {0.9f, 0.7f}) {
    Material material = colored({1, 1, 1, alpha});
    material.alpha_mode = AlphaMode::mask;
    material.alpha_cutoff = 0.4f;
    RendererScene scene = scene_with_ambient(1);
    scene.add(mesh, material, at(0, 0, 1));
    CHECK((renderer.render(scene.list, wall_plan(false, true))[0].depth[5] > 0) == (alpha * 0.5f > 0.4f));
  }
}

TEST_CASE("blended surfaces are drawn over their background, and depth sees those that are at least half solid") {
  Renderer renderer(device());
  const auto glass = [](float grey, float alpha) {
    Material material = colored({grey, grey, grey, alpha});
    material.alpha_mode = AlphaMode::blend;
    material.unlit = true;
    return material;
  };
  Material wall = colored({0.1f, 0.1f, 0.1f, 1});
  wall.unlit = true;
  RendererScene scene = scene_with_ambient(1);
  // In an order that is neither front to back nor back to front.
  scene.add(rectangle(-9, -9, 9, 9), glass(0.4f, 0.25f), at(0, 0, 2));
  scene.add(rectangle(-9, -9, 9, 9), wall, at(0, 0, 5));
  scene.add(rectangle(-9, -9, 9, 9), glass(0.9f, 0.75f), at(0, 0, 3));
  scene.add(rectangle(-9, -9, 9, 9), glass(1.0f, 1.0f), at(0, 0, 6));  // behind the wall
  const double behind = 0.1 * 0.25 + 0.9 * 0.75, expected = behind * 0.75 + 0.4 * 0.25;
  const PassResult both = renderer.render(scene.list, wall_plan(true, true))[0];
  CHECK(both.color[5].r == doctest::Approx(expected).epsilon(kShading));
  CHECK(both.color[5].a == 1);
  CHECK(both.depth[5] == doctest::Approx(0.05 / 3).epsilon(1e-6));
  CHECK(renderer.render(scene.list, wall_plan(false, true))[0].depth[5] == doctest::Approx(0.05 / 3).epsilon(1e-6));
}

TEST_CASE("a blended sky all around the view lies behind blended surfaces near it") {
  Renderer renderer(device());
  const auto glass = [](float grey) {
    Material material = colored({grey, grey, grey, 0.5f});
    material.alpha_mode = AlphaMode::blend;
    material.unlit = true;
    return material;
  };
  // One mesh with a wall 10 m ahead and one 30 m behind: its centre is 10 m behind the view.
  Mesh sky = rectangle(-40, -40, 40, 40);
  for (glm::vec3& p : sky.positions) p.z = 10;
  const Mesh behind = rectangle(-40, -40, 40, 40);
  for (std::size_t i = 0; i < 4; ++i) {
    sky.positions.push_back(behind.positions[i] - glm::vec3(0, 0, 30));
    sky.attributes.push_back(behind.attributes[i]);
  }
  for (const std::uint32_t index : behind.indices) sky.indices.push_back(index + 4);
  compute_bounds(sky);
  RendererScene scene = scene_with_ambient(1);
  scene.add(rectangle(-9, -9, 9, 9), glass(0.8f), at(0, 0, 2));
  scene.add(sky, glass(0.2f), at(0, 0, 0));
  const double expected = (kBackground * 0.5 + 0.2 * 0.5) * 0.5 + 0.8 * 0.5;
  CHECK(renderer.render(scene.list, wall_plan(true, false))[0].color[5].r ==
        doctest::Approx(expected).epsilon(kShading));
}

TEST_CASE("a colour pass gives the same depth as a depth pass") {
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(1);
  for (int i = 0; i < 12; ++i) {
    const glm::dmat4 m = glm::rotate(at(i * 0.3 - 1.6, 0.1 * i - 0.5, 3), 0.2 * i, glm::dvec3(0.3, 1, 0.2));
    Material material;
    material.double_sided = true;
    material.alpha_mode = static_cast<AlphaMode>(i % 3);
    material.opacity = i % 4 == 1 ? 0.6f : i % 4 == 3 ? 0.3f : 1.0f;
    if (i % 2) material.base_color_texture = four_texels();
    scene.add(rectangle(-0.4f, -0.4f, 0.4f, 0.4f), material, m);
  }
  const std::vector<float> alone = copy(renderer.render(scene.list, plan_of(96, 96, 48, false, true))[0].depth);
  CHECK(std::count_if(alone.begin(), alone.end(), [](float d) { return d > 0; }) > 100);
  CHECK(same_bytes<float>(alone, renderer.render(scene.list, plan_of(96, 96, 48, true, true))[0].depth));
}

TEST_SUITE_END();
