// The planes that the triangles of a simple mesh lie in, so that one need not ask each triangle which way it faces.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include <simvis/mesh.h>
#include "engine/geometry/clusters.h"

namespace simvis {

/// A plane, in the mesh's frame: of triangles that face either way.
struct FacePlane {
  glm::dvec3 normal{0};   ///< unit length
  double offset = 0;      ///< dot(normal, p) of points p on it
  double min_height = 0;  ///< of its triangles, each over its longest side
};

struct FacePlanes {
  std::vector<FacePlane> sides;
  double off = 0;    ///< by no more, for each metre that a point is away from the mesh's origin, and
  double off_m = 0;  ///< by no more beside that is its distance from a triangle's plane another than from the side's
};

inline constexpr std::size_t kMaxFacePlanes = 16;

/// No sides if there would be more than kMaxFacePlanes. Triangles with two corners in one place, which are never drawn,
/// do not count.
FacePlanes face_planes_of(const Mesh& mesh, const Clustering& clustering);

}  // namespace simvis
