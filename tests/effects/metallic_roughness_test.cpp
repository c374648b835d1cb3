// How lights and ambient light are reflected, against the formulas of glTF 2.0, appendix B, in double.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include <simvis/effect.h>
#include "tests/support/reference_directions.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("effects");

using namespace simvis;
using namespace simvis::test;

namespace {

const glm::dvec3 kBase(0.9, 0.5, 0.1);
constexpr double kLux = 3;

// The view is a square of about 90 degrees with a pixel on the axis. The wall is 2 m ahead and perpendicular to it.
constexpr int kSide_px = 17, kFocal_px = 8;
const glm::dvec3 kNormal(0, 0, -1);

// Relative error of several dozen float32 operations. float32 turns directions by about 16 u, and the slope of the
// logarithm of the distribution is at most 2 / alpha.
double tolerance(double roughness) { return (64 + 2 / (roughness * roughness) * 16) * 0x1p-24; }
// The driver may decode sRGB by a table or a polynomial: an error of at most half a step of 8 bits in linear light.
constexpr double kTexel = 0.5 / 255;

/// Radiance towards `v` from one light of irradiance `lux` on a surface perpendicular to it. Vectors have unit length.
/// glTF 2.0, B.3.
glm::dvec3 reflected(const glm::dvec3& base, double metallic, double roughness, const glm::dvec3& n,
                     const glm::dvec3& l, const glm::dvec3& v, double lux) {
  const double nl = glm::dot(n, l), nv = glm::dot(n, v);
  if (nl <= 0) return glm::dvec3(0);
  const glm::dvec3 h = glm::normalize(l + v);
  const double a2 = std::pow(roughness, 4), nh = glm::dot(n, h);
  const double d = a2 / (kPi * std::pow(nh * nh * (a2 - 1) + 1, 2));
  const auto masked = [&](double cosine) { return 2 * cosine / (cosine + std::sqrt(a2 + (1 - a2) * cosine * cosine)); };
  // Smith's masking and shadowing, correlated in height: G2 = 1 / (1 + lambda_l + lambda_v), G1 = 1 / (1 + lambda).
  const double g = 1 / (1 / masked(nl) + 1 / masked(nv) - 1);
  const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04), base, metallic);
  const glm::dvec3 f = f0 + (1.0 - f0) * std::pow(1 - glm::dot(v, h), 5);
  const glm::dvec3 diffuse = (1.0 - f) * (1 - metallic) * base / kPi;
  return lux * nl * (diffuse + f * d * g / (4 * nl * nv));
}

Material surface(double metallic, double roughness, const glm::dvec3& base = kBase) {
  Material material = colored(glm::vec4(glm::dvec4(base, 1)));
  material.metallic = static_cast<float>(metallic);
  material.roughness = static_cast<float>(roughness);
  return material;
}

/// One texel, sampled without filtering.
std::shared_ptr<Texture> texel(std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  auto texture = std::make_shared<Texture>(*four_texels());
  texture->width = 1;
  texture->rgba = {r, g, b, 255};
  return texture;
}

SurfaceMap map_of(std::shared_ptr<const Texture> texture) { return {.texture = std::move(texture)}; }

/// A wall of this material, lit from `toward`.
RendererScene wall(const Material& material, const glm::dvec3& toward, double ambient = 0, double lux = kLux) {
  RendererScene scene = scene_with_ambient(ambient);
  scene.add(rectangle(-5, -5, 5, 5), material, at(0, 0, 2));
  scene.add_light({.kind = LightKind::directional, .intensity = lux, .direction = -toward}, glm::dmat4(1));
  return scene;
}

FramePlan wide(bool color, bool depth) { return plan_of(kSide_px, kSide_px, kFocal_px, color, depth); }

glm::dvec3 to_eye(int x, int y) {
  return -glm::normalize(glm::dvec3((x - kSide_px / 2) / double{kFocal_px}, (y - kSide_px / 2) / double{kFocal_px}, 1));
}

glm::dvec3 seen(Renderer& renderer, const RendererScene& scene, int x = kSide_px / 2, int y = kSide_px / 2) {
  return glm::dvec3(
      renderer.render(scene.list, wide(true, false))[0].color[static_cast<std::size_t>(y * kSide_px + x)]);
}

void check(const glm::dvec3& found, const glm::dvec3& expected, double relative, double absolute = 0) {
  for (int c = 0; c < 3; ++c) {
    CAPTURE(c);
    CAPTURE(found[c]);
    CAPTURE(expected[c]);
    CHECK(std::abs(found[c] - expected[c]) <= relative * std::abs(expected[c]) + absolute);
  }
}

const glm::dvec3 kToward[] = {
    {0, 0, -1}, glm::normalize(glm::dvec3(1, 0.5, -1)), glm::normalize(glm::dvec3(-3, 0, -1))};

}  // namespace

TEST_CASE("lights are reflected by appendix B for dielectrics and metals, polished and rough") {
  Renderer renderer(device());
  for (const double metallic : {0.0, 0.4, 1.0}) {
    for (const double roughness : {0.05, 0.3, 0.7, 1.0}) {
      if (metallic == 0 && roughness == 1) continue;  // Lambert's surface, see Material
      for (const glm::dvec3& toward : kToward) {
        const RendererScene scene = wall(surface(metallic, roughness), toward);
        for (const glm::ivec2 pixel : {glm::ivec2(8, 8), {3, 8}, {0, 16}, {13, 5}}) {
          CAPTURE(metallic);
          CAPTURE(roughness);
          CAPTURE(pixel.x);
          CAPTURE(pixel.y);
          // Rounded to float32 as on the GPU.
          const double m = static_cast<float>(metallic), r = static_cast<float>(roughness);
          const glm::dvec3 base{glm::vec3(kBase)};
          check(seen(renderer, scene, pixel.x, pixel.y),
                reflected(base, m, r, kNormal, toward, to_eye(pixel.x, pixel.y), kLux), tolerance(r));
        }
      }
    }
  }
}

TEST_CASE("a surface that is neither metallic nor smooth is Lambertian") {
  Renderer renderer(device());
  check(seen(renderer, wall(surface(0, 1), kToward[1])), kBase / kPi * kLux * -kToward[1].z, tolerance(1));
}

TEST_CASE("a map scales metalness and roughness by linear factors") {
  Renderer renderer(device());
  Material material = surface(0.8, 0.9);
  material.map(MapKind::metallic_roughness) = map_of(texel(255, 128, 64));
  const double metallic = 0.8 * 64 / 255, roughness = 0.9 * 128 / 255;
  for (const glm::dvec3& toward : kToward) {
    check(seen(renderer, wall(material, toward), 5, 8),
          reflected(kBase, metallic, roughness, kNormal, toward, to_eye(5, 8), kLux), tolerance(roughness));
  }
  // Also for a dielectric, and never smoother than kMinRoughness.
  material.metallic = 0;
  material.map(MapKind::metallic_roughness) = map_of(texel(0, 0, 255));
  check(seen(renderer, wall(material, kToward[0])),
        reflected(kBase, 0, kMinRoughness, kNormal, kToward[0], to_eye(8, 8), kLux), tolerance(kMinRoughness));
}

TEST_CASE("a white surface, metal or not, disappears in a white furnace, and no surface shines in it") {
  Renderer renderer(device());
  constexpr float kRadiance = 0.7f;
  for (const double metallic : {0.0, 0.3, 1.0}) {
    for (const double roughness : {0.05, 0.5, 1.0}) {
      CAPTURE(metallic);
      CAPTURE(roughness);
      // The light is off, so the pipeline is that of lit surfaces.
      RendererScene scene = wall(surface(metallic, roughness, glm::dvec3(1)), kToward[1], kRadiance, 0);
      CHECK(seen(renderer, scene) == glm::dvec3(kRadiance));
      CHECK(seen(renderer, scene, 0, 0) == glm::dvec3(kRadiance));
      RendererScene colored_wall = wall(surface(metallic, roughness), kToward[1], kRadiance, 0);
      check(seen(renderer, colored_wall), kBase * double{kRadiance}, 4 * 0x1p-24);
    }
  }
}

TEST_CASE("a rough surface in a furnace of lights reflects no more than arrives") {
  Renderer renderer(device());
  // Lights are spread evenly over the hemisphere in front of the wall, on a Fibonacci spiral. Together they have the
  // radiance 1.
  constexpr int kLights = 32;
  const double solid_angle = 2 * kPi / kLights;
  for (const double metallic : {0.0, 1.0}) {
    CAPTURE(metallic);
    constexpr double kRoughness = 0.75;
    RendererScene scene = scene_with_ambient(0);
    scene.add(rectangle(-5, -5, 5, 5), surface(metallic, kRoughness, glm::dvec3(1)), at(0, 0, 2));
    double expected = 0;
    for (int i = 0; i < kLights; ++i) {
      const double cosine = (i + 0.5) / kLights, sine = std::sqrt(1 - cosine * cosine);
      const double turn = i * kPi * (3 - std::sqrt(5.0));
      const glm::dvec3 toward(sine * std::cos(turn), sine * std::sin(turn), -cosine);
      scene.add_light({.kind = LightKind::directional, .intensity = solid_angle, .direction = -toward}, glm::dmat4(1));
      expected += reflected(glm::dvec3(1), metallic, kRoughness, kNormal, toward, to_eye(8, 8), solid_angle).r;
    }
    const double found = seen(renderer, scene).r;
    CHECK(std::abs(found - expected) <= expected * (tolerance(kRoughness) + kLights * 0x1p-24));
    CHECK(found < 1);
  }
}

TEST_CASE(
    "the roughest metal in a furnace of lights reflects 1 - ln 2 perpendicularly: its microfacets hide the rest") {
  Renderer renderer(device());
  // Seen perpendicularly with alpha = 1, light from the cosine c is reflected with the weight c / (1 + c). Its integral
  // from 0 to 1 is this value. The second derivative is at most 2, which bounds the error of the midpoint rule.
  constexpr int kLights = 32;
  constexpr double kSum = 2.0 / 24 / (kLights * kLights);
  RendererScene scene = scene_with_ambient(0);
  scene.add(rectangle(-5, -5, 5, 5), surface(1, 1, glm::dvec3(1)), at(0, 0, 2));
  for (int i = 0; i < kLights; ++i) {
    const double cosine = (i + 0.5) / kLights;
    scene.add_light({.kind = LightKind::directional,
                     .intensity = 2 * kPi / kLights,
                     .direction = {std::sqrt(1 - cosine * cosine), 0, cosine}},
                    glm::dmat4(1));
  }
  const double found = seen(renderer, scene).r, expected = 1 - std::numbers::ln2;
  CHECK(std::abs(found - expected) <= kSum + expected * (tolerance(1) + kLights * 0x1p-24));
}

TEST_CASE("occlusion dims ambient light by its strength and no other light") {
  Renderer renderer(device());
  for (const double strength : {1.0, 0.25}) {
    CAPTURE(strength);
    Material material = surface(0, 1);
    material.occlusion_strength = static_cast<float>(strength);
    material.map(MapKind::occlusion) = map_of(texel(51, 200, 0));
    const glm::dvec3 lit = kBase / kPi * kLux, around = kBase * 0.5 * (1 + strength * (51 / 255.0 - 1));
    check(seen(renderer, wall(material, kToward[0], 0.5)), lit + around, tolerance(1));
  }
}

TEST_CASE("an emission map is a colour that multiplies the emission") {
  Renderer renderer(device());
  Material material = surface(0, 1, glm::dvec3(0));
  material.emissive = {2, 4, 1};
  material.map(MapKind::emissive) = map_of(texel(188, 90, 0));
  const auto linear = [](int srgb) { return std::pow((srgb / 255.0 + 0.055) / 1.055, 2.4); };
  RendererScene scene = scene_with_ambient(0.5);
  scene.add(rectangle(-5, -5, 5, 5), material, at(0, 0, 2));
  check(seen(renderer, scene), glm::dvec3(2 * linear(188), 4 * linear(90), 0), tolerance(1), 4 * kTexel);
}

TEST_CASE("each map has its own set and transform of texture coordinates") {
  Renderer renderer(device());
  Mesh mesh = rectangle(-5, -5, 5, 5);
  for (VertexAttributes& a : mesh.attributes) {
    a.uv[0] = {0.1f, 0.5f};  // texel 0 of four
    a.uv[1] = {0.4f, 0.5f};  // texel 1
  }
  Material material = surface(0, 1);
  const auto texels = four_texels();
  material.base_color_texture = texels;
  material.uv_set = 1;
  material.emissive = glm::vec3(1);
  material.map(MapKind::emissive) = map_of(texels);
  material.map(MapKind::occlusion) = map_of(texels);
  material.map(MapKind::occlusion).uv_set = 1;
  material.map(MapKind::occlusion).uv_transform[2].x = 0.25f;  // texel 2
  RendererScene scene = scene_with_ambient(1);
  scene.add(mesh, material, at(0, 0, 2));
  const auto linear = [](int srgb) { return std::pow((srgb / 255.0 + 0.055) / 1.055, 2.4); };
  check(seen(renderer, scene), kBase * linear(kGrey[1]) * (kGrey[2] / 255.0) + linear(kGrey[0]), tolerance(1),
        2 * kTexel);
  // One picture in two encodings takes two textures on the device.
  CHECK(renderer.counters().textures_held == 2);
}

namespace {

Material with_all_maps(const Material& plain) {
  Material material = plain;
  const auto grey = texel(100, 100, 100);
  for (SurfaceMap& map : material.maps) map = map_of(grey);
  material.metallic = 1;
  material.roughness = 0.2f;
  return material;
}

}  // namespace

TEST_CASE("depth and its cost are the same for all surfaces") {
  for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::mask}) {
    Material plain = surface(0, 1);
    plain.alpha_mode = mode;
    plain.base_color_texture = four_texels();
    plain.emissive = glm::vec3(1);
    Renderer one(device()), other(device());
    const RendererScene simple = wall(plain, kToward[0]), rich = wall(with_all_maps(plain), kToward[0]);
    for (int frame = 0; frame < 2; ++frame) {
      const std::vector<float> depth = copy(one.render(simple.list, wide(false, true))[0].depth);
      CHECK(same_bytes<float>(depth, other.render(rich.list, wide(false, true))[0].depth));
      CHECK(one.counters() == other.counters());
    }
    CHECK(other.counters().textures_held == (mode == AlphaMode::mask ? 1 : 0));
    other.render(rich.list, wide(true, true));
    CHECK(other.counters().textures_held == 3);  // the base colour, the grey texel as a colour and as numbers
  }
}

TEST_CASE("maps without an effect give the same bytes and counters as no maps") {
  Material plain = surface(0, 1);
  Material off = plain;
  for (const MapKind kind : {MapKind::normal, MapKind::occlusion, MapKind::emissive}) {
    off.map(kind) = map_of(texel(10, 20, 30));
  }
  off.normal_scale = 0;
  off.occlusion_strength = 0;
  Material unlit = with_all_maps(plain), unlit_plain = plain;
  unlit.unlit = unlit_plain.unlit = true;
  Renderer one(device()), other(device());
  for (const auto& [a, b] : {std::pair{plain, off}, std::pair{unlit_plain, unlit}}) {
    const RendererScene simple = wall(a, kToward[1], 0.5), named = wall(b, kToward[1], 0.5);
    const std::vector<glm::vec4> color = copy(one.render(simple.list, wide(true, false))[0].color);
    CHECK(same_bytes<glm::vec4>(color, other.render(named.list, wide(true, false))[0].color));
    CHECK(one.counters() == other.counters());
  }
}

TEST_CASE("neither relief nor roughness is read without a light") {
  Renderer one(device()), other(device());
  Material shaped = surface(0, 1);
  shaped.map(MapKind::normal) = shaped.map(MapKind::metallic_roughness) = map_of(texel(10, 20, 30));
  shaped.metallic = 1;
  RendererScene simple = wall(surface(0, 1), kToward[0], 0.5), named = wall(shaped, kToward[0], 0.5);
  simple.list.lights.clear();
  named.list.lights.clear();
  const std::vector<glm::vec4> color = copy(one.render(simple.list, wide(true, false))[0].color);
  CHECK(same_bytes<glm::vec4>(color, other.render(named.list, wide(true, false))[0].color));
  CHECK(one.counters() == other.counters());
  CHECK(other.counters().textures_held == 0);
}

TEST_CASE("the plan names the effect where colour shows it, and only there") {
  const auto planned = [](const RendererScene& scene, EffectOutput output) {
    FramePlan plan;
    plan.passes.push_back({.name = "CAM", .color = output == kShownInColor, .depth = output == kShownInDepth});
    plan_scene_effects("CAM", 0, scene.list, plan);
    std::string names;
    for (const PlannedEffect& each : plan.effects) names += each.effect + ' ';
    return names;
  };
  const Material plain = surface(0, 1);
  CHECK(planned(wall(plain, kToward[0]), kShownInColor).empty());
  CHECK(planned(wall(with_all_maps(plain), kToward[0]), kShownInColor) == "metallic_roughness normal_maps ");
  CHECK(planned(wall(with_all_maps(plain), kToward[0]), kShownInDepth).empty());
  CHECK(planned(wall(surface(1, 1), kToward[0]), kShownInColor) == "metallic_roughness ");
  CHECK(planned(wall(surface(0, 0.5), kToward[0]), kShownInColor) == "metallic_roughness ");
}

TEST_SUITE_END();
