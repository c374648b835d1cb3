// Which way a mesh's clusters face: what turns its back to a view need not be drawn where back faces are not.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include <simvis/mesh.h>
#include "engine/culling/facing_tolerance.h"
#include "engine/geometry/clusters.h"
#include "engine/geometry/view_projection.h"

namespace simvis {

/// How a cluster's triangles face, in the mesh's frame. The front of a triangle is where its corners run
/// counterclockwise.
struct NormalCone {
  glm::vec3 axis{0};      ///< unit length: the mean of the normals
  float cutoff = -1;      ///< of the angle of a normal to the axis, rounded down; 0 or less: culls nothing
  float apex_offset = 0;  ///< the cluster's centre lies at most so far in front of a triangle's plane, rounded up
  float min_height = 0;   ///< of its triangles, each over its longest side, rounded down
};

/// Of each cluster of triangles, in their order.
std::vector<NormalCone> normal_cones_of(const Mesh& mesh, const Clustering& clustering);

/// A view as it stands to a mesh, for its clusters' facing.
///
/// Conservative down to the pixel: a device decides upon what it has rounded, so a triangle that truly shows its back
/// could show its front there, if it is seen so thin that rounding turns it over. A cluster faces away only where even
/// that could not happen, and where none of its triangles has to be cut at the view's sides.
class NormalConeCuller {
 public:
  /// `limit` and `planes` must be those of the view and of the mesh in it, and stay.
  NormalConeCuller(const FacingTolerance& limit, const MeshPlanes& planes, const glm::dmat4& view_from_mesh);

  /// False for views and meshes that nothing can be told of: the view is parallel, or the mesh is not of the same scale
  /// along all axes.
  bool is_usable() const { return limit_.is_usable() && eye_.has_value(); }

  bool is_backfacing(const Cluster& cluster, const NormalCone& facing) const;

 private:
  const FacingTolerance& limit_;
  const MeshPlanes& planes_;
  std::optional<EyeInMesh> eye_;
  glm::dvec4 depth_;  // depth_ . (p, 1) is the depth of p, in metres
};

}  // namespace simvis
