#include <simvis/surface_point.h>

#include <array>
#include <optional>

#include "engine/base/assert.h"
#include "engine/base/srgb.h"
#include "engine/draw/solid_cloud.h"
#include "engine/draw/splat_cloud.h"
#include "engine/draw/surface_alpha.h"
#include "engine/raycast/item_shape.h"
#include "engine/raycast/ray_triangle.h"

namespace simvis {

namespace {

// The point of a shape that rays meet in place of triangles; empty if the hit is that of a triangle.
std::optional<SurfacePoint> point_of_shape(const DrawList& list, const glm::dmat4& world_from_sensor,
                                           const glm::dvec3& direction, const RayHit& hit) {
  std::optional<SeenShape> seen = shape_of_item(list, hit.item, world_from_sensor);
  if (!seen) return {};
  const Mesh& mesh = *list.meshes[list.items[hit.item].mesh];
  const std::uint32_t face = face_of_hit(*seen, mesh, hit.primitive);
  const SurfaceHit exact = find_hit(intersect(*seen, direction, true), hit.range_m, face);
  const ShapePoint point = shape_point(*seen, direction, exact);
  const Material& material = *list.materials[list.items[hit.item].material];
  const glm::dvec4 color =
      is_solid_cloud(mesh) ? point_color(material, mesh, hit.primitive)
                           : surface_color(material, shape_uv(*seen, direction, hit.range_m, face, material.uv_set));
  return SurfacePoint{.range_m = hit.range_m,
                      .error_bound_m = hit.error_bound_m,
                      .normal = glm::dot(point.normal, direction) > 0 ? -point.normal : point.normal,
                      .normal_error_rad = point.normal_error_rad,
                      .base_color = glm::vec4(color),
                      .material = &material,
                      .item = hit.item,
                      .primitive = hit.primitive};
}

// A splat has no surface: its normal faces the ray. Its colour is that of its centre, seen from the ray's origin.
SurfacePoint point_of_splat(const DrawList& list, const glm::dmat4& world_from_sensor, const glm::dvec3& direction,
                            const RayHit& hit) {
  const DrawItem& item = list.items[hit.item];
  const SplatCloud& cloud = *list.meshes[item.mesh]->splats;
  const glm::dvec3 origin(glm::inverse(list.world_from_node[item.transform]) * world_from_sensor[3]),
      sight = glm::dvec3(cloud.splats[hit.primitive].center) - origin;
  const std::size_t coefficients = harmonics_count(cloud.degree);
  const double distance = glm::length(sight);
  glm::dvec3 color = splat_color(std::span(cloud.harmonics).subspan(hit.primitive * coefficients, coefficients),
                                 distance > 0 ? sight / distance : glm::dvec3(0, 0, 1));
  for (int i = 0; cloud.encoding == SplatEncoding::srgb && i < 3; ++i) color[i] = decode_srgb(color[i]);
  return {.range_m = hit.range_m,
          .error_bound_m = hit.error_bound_m,
          .normal = -direction,
          .base_color = glm::vec4(glm::min(color, glm::dvec3(1)), 1),
          .material = list.materials[item.material].get(),
          .item = hit.item,
          .primitive = hit.primitive};
}

}  // namespace

SurfacePoint surface_point(const DrawList& list, const glm::dmat4& world_from_sensor, const glm::dvec3& direction,
                           const RayHit& hit) {
  const DrawItem& item = list.items[hit.item];
  const Mesh& mesh = *list.meshes[item.mesh];
  if (mesh.splats) return point_of_splat(list, world_from_sensor, direction, hit);
  const Material& material = *list.materials[item.material];
  const MeshPlacement placement = place_mesh(list.world_from_node[item.transform], world_from_sensor);
  if (const auto point = point_of_shape(list, world_from_sensor, direction, hit)) return *point;
  const std::array<glm::dvec3, 3> corners = place_corners(mesh, hit.primitive, placement);
  TriangleHit exact;
  SIMVIS_ASSERT(intersect(ShearedRay(direction), corners, exact));
  const glm::dvec3 weights = exact.weights / (exact.weights.x + exact.weights.y + exact.weights.z);
  const glm::dvec3 edge = corners[1] - corners[0], other = corners[2] - corners[0], across = glm::cross(edge, other);
  const glm::dvec3 normal = glm::normalize(across);
  // The error of a corner is less than the error bound of the range; the error of an edge is less than twice that
  // bound.
  const double turned = 2 * hit.error_bound_m * (glm::length(edge) + glm::length(other)) / glm::length(across);
  return {.range_m = hit.range_m,
          .error_bound_m = hit.error_bound_m,
          .normal = glm::dot(normal, direction) > 0 ? -normal : normal,
          .normal_error_rad = turned,
          .base_color = glm::vec4(surface_color(material, mesh, hit.primitive, weights)),
          .material = &material,
          .item = hit.item,
          .primitive = hit.primitive};
}

}  // namespace simvis
