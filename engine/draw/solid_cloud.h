// Clouds of points that are solid.
#pragma once

#include <simvis/mesh.h>

namespace simvis {

/// Whether a mesh is a cloud whose points stand for spheres or discs: it has the topology `points`, and its `surface`
/// is the shape around each of them. A disc is perpendicular to the vertex's normal, which is taken as exact. Rays meet
/// the shapes, and number them as primitives; cameras draw squares that are as wide as a shape that faces them.
inline bool is_solid_cloud(const Mesh& mesh) {
  return mesh.topology == Topology::points && mesh.surface &&
         (mesh.surface->kind == SurfaceKind::sphere || mesh.surface->kind == SurfaceKind::disc);
}

/// Whether the points of a solid cloud are discs, which have no inside: both sides of them are seen.
inline bool is_cloud_of_discs(const Mesh& mesh) {
  return is_solid_cloud(mesh) && mesh.surface->kind == SurfaceKind::disc;
}

}  // namespace simvis
