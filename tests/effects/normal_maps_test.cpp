// Normal maps against tilted surfaces, and against tangent frames that the test computes.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "tests/support/reference_directions.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("effects");

using namespace simvis;
using namespace simvis::test;

namespace {

constexpr double kAlbedo = 0.5, kSunLux = 3;

// Relative to the irradiance of the light. Vertex normals are stored in 16 bits (1.5e-5 in each direction). Directions
// in the surface are differences between neighbouring pixels of places below 4 m, rounded to 2^-23 m, that lie 0.1 m
// apart.
constexpr double kDirection = 2 * 1.5e-5 + 4 * 0x1p-23 / 0.1;

/// One texel, sampled without filtering.
std::shared_ptr<Texture> texel(const glm::ivec3& rgb) {
  auto texture = std::make_shared<Texture>(*four_texels());
  texture->width = 1;
  texture->rgba = {static_cast<std::uint8_t>(rgb.r), static_cast<std::uint8_t>(rgb.g), static_cast<std::uint8_t>(rgb.b),
                   255};
  return texture;
}

constexpr glm::ivec3 kTilts[] = {{220, 128, 200}, {128, 40, 180}, {70, 190, 230}};

// The meaning of a texel in the tangent frame.
glm::dvec3 tilt_of(const glm::ivec3& rgb, double scale = 1) {
  const glm::dvec3 t = glm::dvec3(rgb) / 255.0 * 2.0 - 1.0;
  return glm::normalize(glm::dvec3(t.x * scale, t.y * scale, t.z));
}

Material matte(const std::shared_ptr<const Texture>& normals = nullptr) {
  Material material = colored(glm::vec4(glm::vec3(static_cast<float>(kAlbedo)), 1));
  material.double_sided = true;
  material.map(MapKind::normal).texture = normals;
  return material;
}

/// The rectangle of renderer_scene.h: u runs along +x, v along +y, and its front faces -z.
RendererScene lit(const Mesh& mesh, const Material& material, const glm::dmat4& m, const glm::dvec3& toward) {
  RendererScene scene = scene_with_ambient(0);
  scene.add(mesh, material, m);
  scene.add_light({.kind = LightKind::directional, .intensity = kSunLux, .direction = -toward}, glm::dmat4(1));
  return scene;
}

double seen_light(Renderer& renderer, const RendererScene& scene) {
  return renderer.render(scene.list, plan_of(17, 17, 8, true, false))[0].color[8 * 17 + 8].r;
}

double lambert(const glm::dvec3& n, const glm::dvec3& toward) {
  return kAlbedo / kPi * kSunLux * std::max(0.0, glm::dot(n, toward));
}

const glm::dvec3 kTowardLight[] = {
    {0, 0, -1}, glm::normalize(glm::dvec3(1, 0, -1)), glm::normalize(glm::dvec3(-1, 2, -2))};

/// Expected appearance: the normal `tilt` in the frame of u, -v and the outward normal of a mesh that `m` places. The
/// other two vectors are its directions of growing u and v.
glm::dvec3 expected_normal(const glm::dmat4& m, const glm::dvec3& u, const glm::dvec3& v, const glm::dvec3& tilt) {
  const glm::dmat3 linear(m);
  const glm::dvec3 n = glm::normalize(glm::transpose(glm::inverse(linear)) * glm::dvec3(0, 0, -1));
  glm::dvec3 t = linear * u;
  t = glm::normalize(t - n * glm::dot(n, t));
  glm::dvec3 b = glm::cross(n, t);
  if (glm::dot(b, linear * -v) < 0) b = -b;
  return glm::normalize(t * tilt.x + b * tilt.y + n * tilt.z);
}

void check(double found, double expected) {
  CAPTURE(found);
  CAPTURE(expected);
  CHECK(std::abs(found - expected) <= kAlbedo / kPi * kSunLux * kDirection);
}

}  // namespace

TEST_CASE("a map with one tilt looks like a tilted plane") {
  Renderer renderer(device());
  for (const glm::ivec3& rgb : kTilts) {
    const glm::dvec3 tilt = tilt_of(rgb);
    const glm::dvec3 n(tilt.x, -tilt.y, -tilt.z);  // v points down, so -v is -y: up
    // A rotation that turns the rectangle's own normal to that direction.
    const glm::dvec3 axis = glm::cross(glm::dvec3(0, 0, -1), n);
    const glm::dmat4 turned = glm::rotate(at(0, 0, 2), std::atan2(glm::length(axis), -n.z), glm::normalize(axis));
    for (const glm::dvec3& toward : kTowardLight) {
      const double mapped = seen_light(renderer, lit(rectangle(-5, -5, 5, 5), matte(texel(rgb)), at(0, 0, 2), toward));
      check(mapped, seen_light(renderer, lit(rectangle(-5, -5, 5, 5), matte(), turned, toward)));
      check(mapped, lambert(n, toward));
    }
  }
}

TEST_CASE("the frame follows texture coordinates that the mesh or the material turns, mirrors or shears") {
  Renderer renderer(device());
  const glm::dmat2 layouts[] = {{-1, 0, 0, 1}, {1, 0, 0, -1},     {0, 1, -1, 0},
                                {0, 1, 1, 0},  {2, 0.5, 0, 0.25}, {-1, 0.3, 0.2, 2}};
  for (const glm::dmat2& uv_from_xy : layouts) {
    // The direction in which u grows at constant v, and the other way round.
    const glm::dmat2 xy_from_uv = glm::inverse(uv_from_xy);
    const glm::dvec3 u(xy_from_uv[0], 0), v(xy_from_uv[1], 0);
    Mesh mesh = rectangle(-5, -5, 5, 5);
    for (VertexAttributes& a : mesh.attributes) a.uv[0] = glm::vec2(uv_from_xy * glm::dvec2(a.uv[0]));
    Material by_transform = matte(texel(kTilts[2]));
    by_transform.map(MapKind::normal).uv_transform =
        glm::mat3x2(glm::vec2(uv_from_xy[0]), glm::vec2(uv_from_xy[1]), glm::vec2(0.25f, 0.5f));
    const glm::dvec3 n = expected_normal(glm::dmat4(1), u, v, tilt_of(kTilts[2]));
    for (const glm::dvec3& toward : kTowardLight) {
      check(seen_light(renderer, lit(mesh, matte(texel(kTilts[2])), at(0, 0, 2), toward)), lambert(n, toward));
      check(seen_light(renderer, lit(rectangle(-5, -5, 5, 5), by_transform, at(0, 0, 2), toward)), lambert(n, toward));
    }
  }
}

TEST_CASE("the frame follows a mesh that is turned, mirrored, stretched or seen from behind") {
  Renderer renderer(device());
  for (const double stretch : {1.0, -2.0}) {
    for (const double turn : {0.7, kPi - 0.4}) {
      CAPTURE(stretch);
      CAPTURE(turn);
      glm::dmat4 m = glm::scale(at(0, 0, 4), glm::dvec3(stretch, 1, 1));
      m = glm::rotate(m, turn, glm::dvec3(0.2, 1, 0));
      glm::dvec3 n = expected_normal(m, {1, 0, 0}, {0, 1, 0}, tilt_of(kTilts[0]));
      const glm::dvec3 flat = glm::transpose(glm::inverse(glm::dmat3(m))) * glm::dvec3(0, 0, -1);
      // A sheet that is bent outwards on one side is bent inwards on the other.
      if (flat.z > 0) n = -n;
      for (const glm::dvec3& toward : kTowardLight) {
        check(seen_light(renderer, lit(rectangle(-3, -3, 3, 3), matte(texel(kTilts[0])), m, toward)),
              lambert(n, toward));
      }
    }
  }
}

TEST_CASE("the scale stretches x and y; a negative scale inverts the relief") {
  Renderer renderer(device());
  for (const double scale : {0.5, 2.0, -1.0}) {
    Material material = matte(texel(kTilts[1]));
    material.normal_scale = static_cast<float>(scale);
    const glm::dvec3 t = tilt_of(kTilts[1], scale), n(t.x, -t.y, -t.z);
    check(seen_light(renderer, lit(rectangle(-5, -5, 5, 5), material, at(0, 0, 2), kTowardLight[2])),
          lambert(n, kTowardLight[2]));
  }
}

TEST_CASE("the surface stays flat to the bit where texture coordinates are degenerate") {
  Renderer renderer(device());
  Mesh mesh = rectangle(-5, -5, 5, 5);
  for (VertexAttributes& a : mesh.attributes) a.uv[0] = {0.3f, 0.6f};
  const double mapped = seen_light(renderer, lit(mesh, matte(texel(kTilts[0])), at(0, 0, 2), kTowardLight[1]));
  CHECK(mapped == seen_light(renderer, lit(mesh, matte(), at(0, 0, 2), kTowardLight[1])));
}

TEST_CASE("highlights follow the relief") {
  Renderer renderer(device());
  // The map tilts a mirror-like wall so that it reflects the light from `toward` into the eye.
  const glm::ivec3 rgb(220, 128, 200);
  const glm::dvec3 t = tilt_of(rgb), n(t.x, -t.y, -t.z), eye(0, 0, -1), toward = 2 * glm::dot(n, eye) * n - eye;
  Material material = matte(texel(rgb));
  material.metallic = 1;
  material.roughness = 0.3f;
  // At the mirror angle: D = 1 / (pi alpha^2), F = 0.5 + 0.5 (1 - cos)^5, and G2 of glTF 2.0, appendix B.
  const double alpha = 0.3 * 0.3, cosine = glm::dot(n, eye);
  const double lambda = (std::sqrt(1 + alpha * alpha * (1 / (cosine * cosine) - 1)) - 1) / 2;
  const double fresnel = kAlbedo + (1 - kAlbedo) * std::pow(1 - cosine, 5);
  const double expected = kSunLux * fresnel / (kPi * alpha * alpha) / (1 + 2 * lambda) / (4 * cosine);
  const double found = seen_light(renderer, lit(rectangle(-5, -5, 5, 5), material, at(0, 0, 2), toward));
  // At the top of the lobe a rotation by e changes it by (e / alpha)^2. The rest is due to the Fresnel term and the
  // cosines.
  CHECK(std::abs(found / expected - 1) <= 2 * std::pow(kDirection / alpha, 2) + 8 * kDirection);
}

TEST_SUITE_END();
