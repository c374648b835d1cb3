// What paths of light see of the maps, masks and vertex colours of surfaces, against closed forms.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "tests/light/path_stage.h"

TEST_SUITE_BEGIN("engine/light");

namespace simvis::test {
namespace {

using Texel = std::array<std::uint8_t, 4>;

// Two texels beside each other, each with sharp edges.
std::shared_ptr<const Texture> two_texels(const Texel& left, const Texel& right) {
  auto texture = std::make_shared<Texture>();
  texture->width = 2;
  texture->height = 1;
  texture->rgba.insert(texture->rgba.end(), left.begin(), left.end());
  texture->rgba.insert(texture->rgba.end(), right.begin(), right.end());
  texture->sampler.magnify = texture->sampler.minify = Filter::nearest;
  return texture;
}

// The definition of sRGB, IEC 61966-2-1.
double linear(std::uint8_t code) {
  const double encoded = code / 255.0;
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

// 4 m x 4 m around the origin, where u goes along x and v against y.
Mesh floor_with_uv() {
  Mesh mesh = rectangle_mesh({-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  const std::array<glm::vec2, 4> uv{{{0, 1}, {1, 1}, {1, 0}, {0, 0}}};
  for (std::size_t i = 0; i < 4; ++i) mesh.attributes[i].uv[0] = uv[i];
  return mesh;
}

constexpr glm::dvec3 kLamp_m{0.5, -0.4, 2}, kEye_m{-0.6, 0.9, 1.5};
constexpr double kIntensity = 8;

// The radiance that the floor shows of a lamp at a point.
double seen_at(const Material& material, const glm::dvec3& at_m, const Mesh& mesh = floor_with_uv()) {
  PathStage stage;
  stage.add(mesh, material);
  stage.list.world_from_node.push_back(glm::translate(glm::dmat4(1), kLamp_m));
  const auto place = static_cast<std::uint32_t>(stage.list.world_from_node.size() - 1);
  stage.list.lights = {{{.kind = LightKind::point, .intensity = kIntensity}, place}};
  return radiance_at(stage, kEye_m, at_m, 4, 1).mean.x;
}

// That of a surface with this reflection.
double expected_at(const SurfaceReflection& reflection, const glm::dvec3& at_m) {
  const glm::dvec3 way = kLamp_m - at_m;
  const double share = reflected_share(reflection, glm::normalize(kEye_m - at_m), glm::normalize(way)).x;
  return share * kIntensity / glm::dot(way, way);
}

// The factors of a map are 8-bit numbers that are stored as float32 or computed in it once.
constexpr double kMapped = 1e-6;

constexpr std::array<glm::dvec3, 2> kPlaces{
    {{-0.9, 0.3, 0}, {1.1, -0.2, 0}}};  // of the left texel and of the right one

TEST_CASE("a picture of the base colour is decoded, and multiplies colour and vertex colours") {
  const std::array<Texel, 2> texels{{{200, 200, 200, 255}, {90, 90, 90, 255}}};
  Material material = matte(0.5);
  material.base_color_texture = two_texels(texels[0], texels[1]);
  for (std::size_t i = 0; i < 2; ++i) {
    const SurfaceReflection expected{.normal = {0, 0, 1}, .base = glm::dvec3(0.5 * linear(texels[i][0]))};
    CHECK(seen_at(material, kPlaces[i]) == doctest::Approx(expected_at(expected, kPlaces[i])).epsilon(kMapped));
  }
  // Vertex colours are linear between the corners: along x from 0 to 1.
  Mesh mesh = floor_with_uv();
  for (VertexAttributes& vertex : mesh.attributes) vertex.color = glm::vec4(glm::vec3(vertex.uv[0].x), 1);
  for (std::size_t i = 0; i < 2; ++i) {
    const double color = (kPlaces[i].x + 2) / 4;
    const SurfaceReflection expected{.normal = {0, 0, 1}, .base = glm::dvec3(0.5 * color * linear(texels[i][0]))};
    CHECK(seen_at(material, kPlaces[i], mesh) == doctest::Approx(expected_at(expected, kPlaces[i])).epsilon(kMapped));
  }
}

TEST_CASE("a map of metallic and roughness multiplies both") {
  const std::array<Texel, 2> texels{{{0, 128, 255, 255}, {0, 230, 51, 255}}};
  Material material = matte(0.5);
  material.roughness = 0.75f;
  material.metallic = 0.5f;
  material.map(MapKind::metallic_roughness).texture = two_texels(texels[0], texels[1]);
  for (std::size_t i = 0; i < 2; ++i) {
    const SurfaceReflection expected{.normal = {0, 0, 1},
                                     .base = glm::dvec3(0.5),
                                     .roughness = 0.75 * texels[i][1] / 255,
                                     .metallic = 0.5 * texels[i][2] / 255,
                                     .matte = false};
    CHECK(seen_at(material, kPlaces[i]) == doctest::Approx(expected_at(expected, kPlaces[i])).epsilon(kMapped));
  }
}

TEST_CASE("a normal map turns the normal along u and against v") {
  const std::array<Texel, 2> texels{{{190, 128, 220, 255}, {128, 60, 200, 255}}};
  Material material = matte(0.5);
  material.roughness = 0.5f;
  material.normal_scale = 0.75f;
  material.map(MapKind::normal).texture = two_texels(texels[0], texels[1]);
  for (std::size_t i = 0; i < 2; ++i) {
    const glm::dvec3 value = glm::dvec3(texels[i][0], texels[i][1], texels[i][2]) * (2 / 255.0) - 1.0;
    const SurfaceReflection expected{.normal = glm::normalize(glm::dvec3(0.75 * value.x, 0.75 * value.y, value.z)),
                                     .base = glm::dvec3(0.5),
                                     .roughness = 0.5,
                                     .matte = false};
    CHECK(seen_at(material, kPlaces[i]) == doctest::Approx(expected_at(expected, kPlaces[i])).epsilon(kMapped));
  }
}

// What a floor shows of a surface at the height 1, whose front is turned down.
SeenRadiance floor_below(const Mesh& mesh, const Material& material) {
  PathStage stage;
  stage.add(rectangle_mesh({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}), matte(0.5));
  stage.add(mesh, material, glm::translate(glm::dmat4(1), {0, 0, 1}) * glm::scale(glm::dmat4(1), {1, -1, -1}));
  return radiance_at(stage, {4, 0, 0.5}, {0.5, 0.3, 0}, 20000, 1);
}

Mesh left_half() { return rectangle_mesh({-2, -2, 0}, {2, 0, 0}, {0, 4, 0}); }

TEST_CASE("an emissive map is seen, and lights others as a lamp of its bright texel") {
  Material shining = lamp(2);
  shining.map(MapKind::emissive).texture = two_texels({180, 180, 180, 255}, {0, 0, 0, 255});
  const double bright = 2 * linear(180);
  CHECK(seen_at(shining, kPlaces[0]) == doctest::Approx(bright).epsilon(kMapped));
  CHECK(seen_at(shining, kPlaces[1]) == 0);
  // Once with the map and once as the half that shines.
  const SeenRadiance mapped = floor_below(floor_with_uv(), shining);
  const SeenRadiance half = floor_below(left_half(), lamp(bright));
  CHECK(half.mean.x > 0.05);
  CHECK(agree(mapped.mean.x, half.mean.x, std::hypot(mapped.stddev.x, half.stddev.x), kMapped));
}

TEST_CASE("a surface that emits lights others by the share that it covers") {
  const SeenRadiance whole = floor_below(floor_with_uv(), lamp(2)), half = floor_below(left_half(), lamp(2));
  CHECK(half.mean.x > 0.05);
  Material thin = lamp(2), blended = lamp(2), sign = lamp(2);
  thin.opacity = 0.25f;
  blended.alpha_mode = AlphaMode::blend;
  blended.base_color.a = 0.25f;
  for (const Material& material : {thin, blended}) {
    const SeenRadiance seen = floor_below(floor_with_uv(), material);
    CHECK(agree(seen.mean.x, whole.mean.x / 4, std::hypot(seen.stddev.x, whole.stddev.x / 4), kMapped));
  }
  sign.alpha_mode = AlphaMode::mask;
  sign.base_color_texture = two_texels({255, 255, 255, 255}, {255, 255, 255, 0});
  const SeenRadiance seen = floor_below(floor_with_uv(), sign);
  CHECK(agree(seen.mean.x, half.mean.x, std::hypot(seen.stddev.x, half.stddev.x), kMapped));
}

// 101 / 255 is below the cutoff and 103 / 255 above it. 102 / 255 = 0.4 is the cutoff as float32, which is above 0.4.
TEST_CASE("the removed texels of a mask let the eye and the lamp through, at a cutoff that they do not reach") {
  constexpr float kCutoff = 0.4f;
  static_assert(102 / 255.0 < static_cast<double>(kCutoff) && static_cast<float>(102 / 255.0) == kCutoff);
  Material leaf = matte(0);
  leaf.alpha_mode = AlphaMode::mask;
  leaf.alpha_cutoff = kCutoff;
  leaf.double_sided = true;
  const auto seen = [&](const glm::dvec3& leaf_m, bool is_there) {
    PathStage stage;
    stage.add(rectangle_mesh({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}), matte(0.5));
    if (is_there) stage.add(floor_with_uv(), leaf, glm::translate(glm::dmat4(1), leaf_m));
    stage.list.world_from_node.push_back(glm::translate(glm::dmat4(1), {0, 0, 3}));
    const auto place = static_cast<std::uint32_t>(stage.list.world_from_node.size() - 1);
    stage.list.lights = {{{.kind = LightKind::point, .intensity = kIntensity}, place}};
    return radiance_at(stage, {-9, 0, 1}, {0, 0, 0}, 4, 1).mean.x;
  };
  const double open = seen({0, 0, 0}, false);
  CHECK(open > 0);
  for (const std::uint8_t kept : {std::uint8_t{102}, std::uint8_t{103}}) {
    CAPTURE(kept);
    leaf.base_color_texture = two_texels({255, 255, 255, 101}, {255, 255, 255, kept});
    CHECK(seen({1, 0, 1.5}, true) == open);     // the lamp through the left texel
    CHECK(seen({-1, 0, 1.5}, true) == 0);       // the right one blocks it
    CHECK(seen({-3.5, 0, 0.5}, true) == open);  // the eye, 4.5 m from the floor's point, through the left texel
    CHECK(seen({-5.5, 0, 0.5}, true) == 0);
  }
}

TEST_CASE("a texel of a mask at the cutoff emits, and lights others") {
  Material sign = lamp(2);
  sign.alpha_mode = AlphaMode::mask;
  sign.alpha_cutoff = 0.4f;
  sign.base_color_texture = two_texels({255, 255, 255, 101}, {255, 255, 255, 102});
  CHECK(seen_at(sign, kPlaces[1]) == 2);
  const SeenRadiance seen = floor_below(floor_with_uv(), sign);
  const SeenRadiance half = floor_below(rectangle_mesh({0, -2, 0}, {2, 0, 0}, {0, 4, 0}), lamp(2));
  CHECK(half.mean.x > 0.05);
  CHECK(agree(seen.mean.x, half.mean.x, std::hypot(seen.stddev.x, half.stddev.x), kMapped));
}

}  // namespace
}  // namespace simvis::test
