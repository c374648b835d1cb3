// Normal cones of a mesh's clusters. A cluster of back faces need not be drawn where back faces are culled.
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

/// The directions that a cluster's triangles face, in the mesh's frame. The corners of a triangle run counterclockwise
/// when seen from the front.
struct NormalCone {
  glm::vec3 axis{0};      ///< unit length: the mean direction of the normals
  float cutoff = -1;      ///< smallest cosine between a normal and the axis, rounded down; 0 or less: culls nothing
  float apex_offset = 0;  ///< largest distance of the cluster's centre in front of a triangle's plane, rounded up
  float min_height = 0;   ///< smallest height of its triangles, each over the longest side, rounded down
};

/// One cone for each cluster of triangles, in the order of the clusters. `pool` has the threads to use, null for the
/// calling thread alone.
std::vector<NormalCone> normal_cones_of(const Mesh& mesh, const Clustering& clustering, ThreadPool* pool = nullptr);

/// Tests the normal cones of one mesh in one view.
///
/// The test is conservative to the pixel. A device decides on rounded coordinates. If a triangle appears so thin that
/// rounding can reverse its winding, it may show its front there although it truly shows its back. A cluster counts as
/// back-facing only if this cannot happen and if no side of the view clips any of its triangles.
class NormalConeCuller {
 public:
  /// `limit` is that of the view, and `planes` are those of the mesh in the view. Both must outlive this object.
  NormalConeCuller(const FacingTolerance& limit, const MeshPlanes& planes, const glm::dmat4& view_from_mesh);

  /// False if the view is orthographic, or if the mesh is not scaled equally along all axes.
  bool is_usable() const { return limit_.is_usable() && eye_.has_value(); }

  bool is_backfacing(const Cluster& cluster, const NormalCone& facing) const;

 private:
  const FacingTolerance& limit_;
  const MeshPlanes& planes_;
  std::optional<EyeInMesh> eye_;
  glm::dvec4 depth_;  // dot(depth_, (p, 1)) is the depth of p along Z, in metres
};

}  // namespace simvis
