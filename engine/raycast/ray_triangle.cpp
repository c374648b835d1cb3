// This file is compiled without contraction of products and sums (-ffp-contract=off), because the two triangles at a
// shared edge must compute opposite signs for it.
#include "engine/raycast/ray_triangle.h"

#include <algorithm>
#include <cmath>

namespace simvis {

namespace {

constexpr double kUnit = 0x1p-53;

// p x q with an exact sign. If the rounded products differ, the exact products differ in the same direction.
double cross_of(const glm::dvec2& p, const glm::dvec2& q) {
  const double a = p.x * q.y, b = p.y * q.x;
  if (a != b) return a - b;
  return std::fma(p.x, q.y, -a) - std::fma(p.y, q.x, -b);
}

glm::dvec2 sheared(const ShearedRay& ray, const glm::dvec3& corner) {
  const double z = corner[ray.z];
  return {corner[ray.x] - ray.shear_x * z, corner[ray.y] - ray.shear_y * z};
}

}  // namespace

MeshPlacement place_mesh(const glm::dmat4& world_from_mesh, const glm::dmat4& world_from_sensor) {
  const glm::dmat3 sensor_from_world = glm::transpose(glm::dmat3(world_from_sensor));
  return {sensor_from_world * glm::dmat3(world_from_mesh),
          sensor_from_world * glm::dvec3(world_from_mesh[3] - world_from_sensor[3])};
}

std::array<glm::dvec3, 3> place_corners(const Mesh& mesh, std::uint32_t primitive, const MeshPlacement& placement) {
  std::array<glm::dvec3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 p(mesh.positions[mesh.indices[std::size_t{3} * primitive + k]]);
    corners[k] = placement.linear * p + placement.offset;
  }
  return corners;
}

std::array<glm::dvec3, 4> place_vertices(const Mesh& mesh, const std::array<std::uint32_t, 4>& vertices,
                                         const MeshPlacement& placement) {
  std::array<glm::dvec3, 4> placed;
  for (std::size_t k = 0; k < 4; ++k) {
    placed[k] = placement.linear * glm::dvec3(mesh.positions[vertices[k]]) + placement.offset;
  }
  return placed;
}

ShearedRay::ShearedRay(const glm::dvec3& direction) {
  const glm::dvec3 size = glm::abs(direction);
  z = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  x = (z + 1) % 3;
  y = (z + 2) % 3;
  per_z = 1 / direction[z];
  shear_x = direction[x] / direction[z];
  shear_y = direction[y] / direction[z];
}

bool intersect(const ShearedRay& ray, const std::array<glm::dvec3, 3>& corners, TriangleHit& hit) {
  const glm::dvec2 a = sheared(ray, corners[0]), b = sheared(ray, corners[1]), c = sheared(ray, corners[2]);
  const double u = cross_of(b, c), v = cross_of(c, a);
  if ((u < 0 && v > 0) || (u > 0 && v < 0)) return false;
  const double w = cross_of(a, b);
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
  const double area = u + v + w;
  if (area == 0) return false;
  const double az = corners[0][ray.z] * ray.per_z, bz = corners[1][ray.z] * ray.per_z,
               cz = corners[2][ray.z] * ray.per_z;
  // The range is a weighted mean of the corners' ranges. The clamp keeps it between them when the weights of a nearly
  // edge-on triangle are rounded.
  const double range = std::clamp((u * az + v * bz + w * cz) / area, std::min({az, bz, cz}), std::max({az, bz, cz}));
  if (!(range > 0)) return false;
  hit = {range, {u, v, w}};
  return true;
}

double range_error_bound(const ShearedRay& ray, const std::array<glm::dvec3, 3>& corners, const TriangleHit& hit,
                         double corner_error_m) {
  const double area = std::abs(hit.weights.x + hit.weights.y + hit.weights.z);
  double farthest = 0, below = 0, above = 0, size = 0;
  for (const glm::dvec3& corner : corners) {
    farthest = std::max(farthest, glm::length(sheared(ray, corner)));
    const double range = corner[ray.z] * ray.per_z;
    below = std::max(below, hit.range_m - range);
    above = std::max(above, range - hit.range_m);
    size = std::max(size, std::abs(range));
  }
  const double normal = glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  const double slant = normal * std::abs(ray.per_z) / area;  // 1 / cos(incidence)
  const double weights = 6 * kUnit * farthest * farthest / area * std::max(below, above);
  const double of_place = corner_error_m * slant + weights + 6 * kUnit * size;
  return std::min(of_place, std::max(below, above) + 2 * corner_error_m);
}

}  // namespace simvis
