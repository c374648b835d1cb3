#include "engine/light/lit_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <optional>

#include "engine/base/assert.h"
#include "engine/draw/solid_cloud.h"
#include "engine/draw/surface_alpha.h"
#include "engine/draw/surface_map.h"
#include "engine/light/surface_shares.h"
#include "engine/raycast/item_shape.h"
#include "engine/raycast/ray_triangle.h"

namespace simvis {
namespace {

// A point of a triangle in the frame of a ray that starts at the origin.
struct TrianglePoint {
  const Mesh& mesh;
  std::uint32_t primitive;
  glm::dmat3 view_from_mesh;
  std::array<glm::dvec3, 3> corners_m;
  glm::dvec3 weights{0};

  const VertexAttributes& vertex(std::size_t corner) const {
    return mesh.attributes[mesh.indices[3 * std::size_t{primitive} + corner]];
  }
  glm::dvec3 edge(std::size_t corner) const { return corners_m[corner] - corners_m[0]; }
  glm::dvec2 uv(const SurfaceMap& map, std::size_t corner) const {
    return glm::dmat3x2(map.uv_transform) * glm::dvec3(vertex(corner).uv[map.uv_set], 1);
  }
  /// Unit length.
  glm::dvec3 outward() const {
    const glm::dvec3 across = glm::normalize(glm::cross(edge(1), edge(2)));
    return glm::determinant(view_from_mesh) < 0 ? -across : across;
  }
};

TrianglePoint triangle_point(const Mesh& mesh, const glm::dmat4& world_from_mesh, const glm::dmat4& world_from_ray,
                             const glm::dvec3& direction, std::uint32_t primitive) {
  const MeshPlacement placement = place_mesh(world_from_mesh, world_from_ray);
  TrianglePoint point{mesh, primitive, placement.linear, place_corners(mesh, primitive, placement)};
  TriangleHit exact;
  SIMVIS_ASSERT(intersect(ShearedRay(direction), point.corners_m, exact));
  point.weights = exact.weights / (exact.weights.x + exact.weights.y + exact.weights.z);
  return point;
}

// A mask compares in float32, as rays do (surface_alpha()).
double covered_by_alpha(const Material& material, double alpha) {
  if (material.alpha_mode == AlphaMode::blend) return std::clamp(alpha, 0.0, 1.0) * material.opacity;
  const bool kept = material.alpha_mode == AlphaMode::opaque || static_cast<float>(alpha) >= material.alpha_cutoff;
  return kept ? static_cast<double>(material.opacity) : 0;
}

// The normal of the normal map, with the directions of shaders/surface.glsl.
glm::dvec3 bent_normal(const Material& material, const TrianglePoint& point, const glm::dvec3& outward) {
  const SurfaceMap& map = material.map(MapKind::normal);
  const glm::dvec4 value = map_value(map, MapKind::normal, point.mesh, point.primitive, point.weights);
  const glm::dvec3 bend = (glm::dvec3(value) * 2.0 - 1.0) * glm::dvec3(glm::dvec2(material.normal_scale), 1);
  const glm::dvec3 first = point.edge(1), second = point.edge(2);
  const glm::dvec2 corner = point.uv(map, 0), u = point.uv(map, 1) - corner, v = point.uv(map, 2) - corner;
  const double area = u.x * v.y - v.x * u.y;
  const glm::dvec3 along_u = (first * v.y - second * u.y) * glm::sign(area);
  const glm::dvec3 against_v = (first * v.x - second * u.x) * glm::sign(area);
  const glm::dvec3 in_plane = along_u - outward * glm::dot(outward, along_u);
  if (glm::dot(in_plane, in_plane) == 0) return outward;
  const glm::dvec3 tangent = glm::normalize(in_plane), across = glm::cross(outward, tangent);
  const glm::dvec3 bitangent = glm::dot(across, against_v) < 0 ? -across : across;
  return glm::normalize(tangent * bend.x + bitangent * bend.y + outward * bend.z);
}

// Outwards, unit length.
glm::dvec3 shading_normal(const Material& material, const TrianglePoint& point, const glm::dvec3& outward) {
  glm::dvec3 normal(0);
  for (std::size_t k = 0; k < 3; ++k) {
    normal += point.weights[static_cast<glm::length_t>(k)] * glm::dvec3(point.vertex(k).normal);
  }
  // The inverse transpose keeps normals perpendicular under any scale.
  normal = glm::transpose(glm::inverse(point.view_from_mesh)) * normal;
  const glm::dvec3 smooth = glm::dot(normal, normal) > 0 ? glm::normalize(normal) : outward;
  return material.map(MapKind::normal).texture != nullptr ? bent_normal(material, point, smooth) : smooth;
}

void take_roughness(const Material& material, const TrianglePoint* point, SurfaceReflection& reflection) {
  const SurfaceMap& map = material.map(MapKind::metallic_roughness);
  reflection.roughness = material.roughness;
  reflection.metallic = material.metallic;
  reflection.matte = material.roughness >= 1 && material.metallic == 0 && map.texture == nullptr;
  if (map.texture != nullptr && point != nullptr) {
    const glm::dvec4 factor =
        map_value(map, MapKind::metallic_roughness, point->mesh, point->primitive, point->weights);
    reflection.roughness *= factor.g;
    reflection.metallic *= factor.b;
  }
  reflection.roughness = std::max(reflection.roughness, static_cast<double>(kMinRoughness));
}

}  // namespace

glm::dvec3 emitted_radiance(const Material& material, const Mesh& mesh, std::uint32_t primitive,
                            const glm::dvec3& weights) {
  const glm::dvec3 factor(material.emissive);
  const SurfaceMap& map = material.map(MapKind::emissive);
  if (map.texture == nullptr || factor == glm::dvec3(0)) return factor;
  return factor * glm::dvec3(map_value(map, MapKind::emissive, mesh, primitive, weights));
}

double covered_share(const Material& material, const Mesh& mesh, std::uint32_t primitive, const glm::dvec3& weights) {
  return covered_by_alpha(material, surface_color(material, mesh, primitive, weights).a);
}

namespace {

// A shape that rays meet in place of triangles: its maps are those of the base colour alone.
LitSurface lit_shape(SeenShape& shape, const Mesh& mesh, const Material& material, const glm::dvec3& direction,
                     const RayHit& hit) {
  const std::uint32_t face = face_of_hit(shape, mesh, hit.primitive);
  const glm::dvec3 outward = shape_point(shape, direction, {hit.range_m, hit.error_bound_m, face}).normal;
  const bool front = glm::dot(outward, direction) < 0;
  LitSurface surface{.face = front ? outward : -outward};
  const glm::dvec4 color =
      is_solid_cloud(mesh) ? point_color(material, mesh, hit.primitive)
                           : surface_color(material, shape_uv(shape, direction, hit.range_m, face, material.uv_set));
  surface.covered = covered_by_alpha(material, color.a);
  surface.reflection = {.normal = surface.face, .base = glm::dvec3(color)};
  take_roughness(material, nullptr, surface.reflection);
  if (front || material.double_sided) surface.emission = glm::dvec3(material.emissive);
  return surface;
}

LitSurface lit_triangle(const TrianglePoint& point, const Material& material, const glm::dvec3& direction) {
  const glm::dvec3 outward = point.outward();
  const bool front = glm::dot(outward, direction) < 0;
  const double side = front ? 1 : -1;
  LitSurface surface{.face = outward * side};
  const glm::dvec4 color = surface_color(material, point.mesh, point.primitive, point.weights);
  const glm::dvec3 smooth = shading_normal(material, point, outward) * side;
  surface.covered = covered_by_alpha(material, color.a);
  surface.reflection = {.normal = glm::dot(smooth, direction) < 0 ? smooth : surface.face, .base = glm::dvec3(color)};
  take_roughness(material, &point, surface.reflection);
  if (front || material.double_sided) {
    surface.emission = emitted_radiance(material, point.mesh, point.primitive, point.weights);
  }
  return surface;
}

}  // namespace

LitSurface lit_surface(const DrawList& list, const Material& material, const glm::dmat4& world_from_view,
                       const glm::dvec3& origin_m, const glm::dvec3& direction, const RayHit& hit) {
  const DrawItem& item = list.items[hit.item];
  const Mesh& mesh = *list.meshes[item.mesh];
  const glm::dmat4 world_from_ray = glm::translate(world_from_view, origin_m);
  LitSurface surface;
  if (std::optional<SeenShape> shape = shape_of_item(list, hit.item, world_from_ray)) {
    surface = lit_shape(*shape, mesh, material, direction, hit);
  } else {
    const glm::dmat4& world_from_mesh = list.world_from_node[item.transform];
    surface = lit_triangle(triangle_point(mesh, world_from_mesh, world_from_ray, direction, hit.primitive), material,
                           direction);
  }
  if (material.unlit) {
    surface.emission = surface.reflection.base;
    surface.matte = 0;
  } else {
    const SurfaceShares shares = surface_shares(material, 1, std::min(-glm::dot(surface.face, direction), 1.0));
    surface.matte = shares.matte;
    surface.reflected = shares.reflected;
    surface.passed = shares.passed * surface.reflection.base;
  }
  return surface;
}

}  // namespace simvis
