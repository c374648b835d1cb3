// How far two surfaces of triangles are apart, bounded: the Hausdorff distance.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "engine/geometry/bvh.h"

namespace simvis {

class ThreadPool;

/// The triangles of a surface, in a tree that finds the nearest one.
class SurfaceTree {
 public:
  using Triangle = std::array<glm::dvec3, 3>;

  /// `indices` has three for each triangle and is not empty. `pool` has the threads of the build, null for the calling
  /// thread alone; the tree does not depend on it.
  SurfaceTree(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices, ThreadPool* pool = nullptr);

  /// Neighbours in the list are neighbours in space.
  std::span<const Triangle> triangles() const { return triangles_; }

  struct Nearest {
    const Triangle* triangle = nullptr;
    double square = 0;  ///< of the distance
  };

  /// The triangle nearest to a point, or any whose squared distance is at most `enough`. The search begins with `hint`,
  /// a triangle that may be near.
  Nearest nearest(const glm::dvec3& point, const Triangle* hint, double enough) const;

 private:
  std::vector<Triangle> triangles_;  // in the order of the leaves
  Bvh bvh_;
};

/// An upper bound on the distance from any point of either surface to the other surface. It exceeds the larger of the
/// true distance and `floor`, which is above 0, by at most a fifth, except at triangles that are longer than 2^7
/// times `floor`, where it may be larger. `pool` has the threads to use, null for the calling thread alone; the result
/// does not depend on it.
double surface_deviation(const SurfaceTree& a, const SurfaceTree& b, double floor, ThreadPool* pool = nullptr);

}  // namespace simvis
