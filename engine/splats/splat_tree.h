// The splats of one cloud with a tree, for rays from any place.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "engine/draw/splat_cloud.h"
#include "engine/geometry/bvh.h"

namespace simvis {

/// A ray in the frame of a mesh: the point at the range t is origin + t * direction, whatever the length of direction.
struct MeshRay {
  glm::dvec3 origin{0}, direction{0};
  double origin_error = 0;     ///< of its origin, by rounding
  double direction_error = 0;  ///< of its direction, by rounding
  double end_m = 0;            ///< splats count at ranges above 0 and below this one
};

/// A splat on a ray: see SplatPeak.
struct SplatOnRay {
  double range_m = 0, alpha = 0;
  double error_bound_m = 0;  ///< of range_m
  std::uint32_t splat = 0;   ///< in SplatCloud::splats
};

class SplatTree {
 public:
  explicit SplatTree(std::shared_ptr<const SplatCloud> cloud);

  const SplatCloud& cloud() const { return *cloud_; }
  /// Appends the splats that stop light of the ray, in any order.
  void find(const MeshRay& ray, std::vector<SplatOnRay>& found) const;

 private:
  void test(const MeshRay& ray, std::uint32_t splat, std::vector<SplatOnRay>& found) const;

  std::shared_ptr<const SplatCloud> cloud_;
  std::vector<std::uint32_t> visible_;  // numbers of the splats that are seen at all: the primitives of the tree
  Bvh tree_;
};

}  // namespace simvis
