// Flat patches with a closed form, from which the scenes of hard cases are built.
//
// The numbers of a patch are float32 and chosen so that its corners are exact. The measured mesh and the truth are then
// the same surface.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/assert.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/random_room.h"

namespace simvis {

/// A parallelogram: corner + s side_a + t side_b with s and t from 0 to 1, in metres.
struct Patch {
  glm::vec3 corner{0}, side_a{0}, side_b{0};
};

/// Two triangles, split between the ends of side_a and side_b.
inline Mesh mesh_of(const Patch& patch) {
  const glm::dvec3 c(patch.corner), a(patch.side_a), b(patch.side_b);
  Mesh mesh;
  for (const glm::dvec3& p : {c, c + a, c + a + b, c + b}) {
    mesh.positions.push_back(p);
    SIMVIS_ASSERT(glm::dvec3(mesh.positions.back()) == p);  // exact in float32
  }
  mesh.indices = {0, 1, 3, 1, 2, 3};
  return mesh;
}

/// A rectangle on the ground, z = 0, from -half_m to half_m in x and y.
inline Patch ground(float half_m) { return {{-half_m, -half_m, 0}, {2 * half_m, 0, 0}, {0, 2 * half_m, 0}}; }

/// Four triangles around the origin, none perpendicular to an axis and all at different distances: the range differs in
/// each direction, on each side of each border and in each pixel. Corners are exact in float32.
inline Mesh skew_room() {
  Mesh mesh;
  mesh.positions = {{7, 1, -2}, {-3, 6, -2.5f}, {-4, -5, -3}, {0.5f, 0.25f, 6}};
  mesh.indices = {0, 1, 2, 0, 1, 3, 1, 2, 3, 2, 0, 3};
  return mesh;
}

/// The range of a beam from inside a convex closed mesh: the nearest plane ahead. Sensor at `origin`.
inline double convex_range(const Mesh& mesh, const glm::dvec3& origin, const glm::dvec3& direction) {
  double range = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::dvec3 a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
        c(mesh.positions[mesh.indices[i + 2]]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double t = glm::dot(normal, a - origin) / glm::dot(normal, direction);
    if (t > 0) range = std::min(range, t);
  }
  return range;
}

/// The range at which a ray meets the plane of the patch; negative or not finite if it does not.
inline double plane_range(const Patch& patch, const glm::dvec3& origin, const glm::dvec3& direction) {
  const glm::dvec3 normal = glm::cross(glm::dvec3(patch.side_a), glm::dvec3(patch.side_b));
  return glm::dot(normal, glm::dvec3(patch.corner) - origin) / glm::dot(normal, direction);
}

/// The range at which a ray hits the patch including its borders; +infinity if it misses. The borders are as wide as
/// rounding makes them, so adjacent patches leave no gap.
inline double patch_range(const Patch& patch, const glm::dvec3& origin, const glm::dvec3& direction) {
  constexpr double kNone = std::numeric_limits<double>::infinity(), kBorder = 1e-12;
  const double range = plane_range(patch, origin, direction);
  if (!(range > 0) || !std::isfinite(range)) return kNone;
  const glm::dvec3 a(patch.side_a), b(patch.side_b), normal = glm::cross(a, b);
  const glm::dvec3 from_corner = origin + range * direction - glm::dvec3(patch.corner);
  const double s = glm::dot(glm::cross(from_corner, b), normal) / glm::dot(normal, normal);
  const double t = glm::dot(glm::cross(a, from_corner), normal) / glm::dot(normal, normal);
  return std::min(s, t) >= -kBorder && std::max(s, t) <= 1 + kBorder ? range : kNone;
}

/// The range of a beam from this pose to patches in world coordinates: the nearest hit.
inline ClosedForm nearest_of(const std::vector<Patch>& patches, const glm::dmat4& world_from_sensor) {
  return [patches, world_from_sensor](const glm::dvec3& direction) {
    double range = std::numeric_limits<double>::infinity();
    for (const Patch& patch : patches) {
      range = std::min(range,
                       patch_range(patch, glm::dvec3(world_from_sensor[3]), glm::dmat3(world_from_sensor) * direction));
    }
    return range;
  };
}

/// A world of patches, each an item of its own, seen from a pose.
inline HardCase patch_case(std::string name, const std::vector<Patch>& patches,
                           const glm::dmat4& world_from_sensor = glm::dmat4(1.0)) {
  HardCase hard{.name = std::move(name), .world_from_sensor = world_from_sensor};
  for (const Patch& patch : patches) add_item(hard.world, mesh_of(patch), glm::dmat4(1.0));
  hard.truth = nearest_of(patches, world_from_sensor);
  return hard;
}

/// Patches as one mesh, in which corners at the same place are one vertex.
inline Mesh welded(const std::vector<Patch>& patches) {
  Mesh mesh;
  for (const Patch& patch : patches) {
    const Mesh piece = mesh_of(patch);
    for (const std::uint32_t index : piece.indices) {
      const auto same = std::ranges::find(mesh.positions, piece.positions[index]);
      mesh.indices.push_back(static_cast<std::uint32_t>(same - mesh.positions.begin()));
      if (same == mesh.positions.end()) mesh.positions.push_back(piece.positions[index]);
    }
  }
  return mesh;
}

/// The same world with the patches welded.
inline HardCase welded_case(std::string name, const std::vector<Patch>& patches,
                            const glm::dmat4& world_from_sensor = glm::dmat4(1.0)) {
  HardCase hard{.name = std::move(name), .world_from_sensor = world_from_sensor};
  add_item(hard.world, welded(patches), glm::dmat4(1.0));
  hard.truth = nearest_of(patches, world_from_sensor);
  return hard;
}

}  // namespace simvis
