#include "engine/culling/face_planes.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

// Tolerance of unit normals, and of distances relative to the distance of the mesh's farthest corner from its origin:
// some hundred times the float32 rounding errors on a grid of a hundred squares.
constexpr double kFlat = 1e-4;

}  // namespace

FacePlanes face_planes_of(const Mesh& mesh, const Clustering& clustering) {
  const double reach =
      glm::length(glm::max(glm::abs(glm::dvec3(mesh.bounds_min)), glm::abs(glm::dvec3(mesh.bounds_max))));
  FacePlanes flat{.sides = {}, .off = kFlat, .off_m = 2 * kFlat * reach};
  for (const Cluster& cluster : clustering.clusters) {
    const auto vertices = clustering.vertices_of(cluster);
    const auto corners = clustering.corners_of(cluster);
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      const glm::vec3 &p = mesh.positions[vertices[corners[i]]], &q = mesh.positions[vertices[corners[i + 1]]],
                      &r = mesh.positions[vertices[corners[i + 2]]];
      if (p == q || q == r || r == p) continue;
      const glm::dvec3 a(p), ab = glm::dvec3(q) - a, ac = glm::dvec3(r) - a, across = glm::cross(ab, ac);
      const double twice_area = glm::length(across);
      const double longest = std::max({glm::length(ab), glm::length(ac), glm::distance(ab, ac)});
      if (!(twice_area > 0)) return {};
      const glm::dvec3 normal = across / twice_area;
      const auto found = std::ranges::find_if(flat.sides, [&](const FacePlane& side) {
        const double sign = glm::dot(side.normal, normal) < 0 ? -1 : 1;
        return glm::distance(side.normal, sign * normal) <= kFlat &&
               std::abs(glm::dot(side.normal, a) - side.offset) <= kFlat * reach;
      });
      const double height = twice_area / longest;
      if (found != flat.sides.end()) {
        found->min_height = std::min(found->min_height, height);
      } else if (flat.sides.size() == kMaxFacePlanes) {
        return {};
      } else {
        flat.sides.push_back({normal, glm::dot(normal, a), height});
      }
    }
  }
  return flat;
}

}  // namespace simvis
