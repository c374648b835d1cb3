// The planes that contain the triangles of a simple mesh, so that facing tests need one test for each plane instead of
// one for each triangle.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include <simvis/mesh.h>
#include "engine/geometry/clusters.h"

namespace simvis {

/// A plane in the mesh's frame. Its triangles may face either way.
struct FacePlane {
  glm::dvec3 normal{0};   ///< unit length
  double offset = 0;      ///< dot(normal, p) of the points p on the plane
  double min_height = 0;  ///< smallest height of its triangles, each over the longest side
};

/// The planes of a mesh. At a point p in the mesh's frame, the distance from a triangle's plane and the distance from
/// that triangle's FacePlane differ by at most off * length(p) + off_m.
struct FacePlanes {
  std::vector<FacePlane> sides;
  double off = 0;    ///< share of length(p) in the bound
  double off_m = 0;  ///< constant part of the bound
};

inline constexpr std::size_t kMaxFacePlanes = 16;

/// Returns no sides if the mesh needs more than kMaxFacePlanes, or if a triangle with three distinct corners has no
/// area. Triangles with two corners at one position are never drawn and are ignored.
FacePlanes face_planes_of(const Mesh& mesh, const Clustering& clustering);

}  // namespace simvis
