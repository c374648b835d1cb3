// A mesh with a tree over its triangles, for casting rays on the device and on the host.
#pragma once

#include <array>

#include "engine/ray_items.h"

namespace simvis {

class BvhMesh : public RayMesh {
 public:
  explicit BvhMesh(std::shared_ptr<const Mesh> mesh);

  /// Over the triangles in the unit frame, rounded to float32. Empty if the radius is 0.
  const Bvh& bvh() const { return bvh_; }

  /// A triangle's corners in the unit frame, rounded: off by up to 2^-25 per axis.
  std::array<glm::vec3, 3> unit_corners(std::uint32_t primitive) const;

 private:
  Bvh bvh_;
};

}  // namespace simvis
