// Clouds of points that are solid.
#pragma once

#include <simvis/mesh.h>

namespace simvis {

/// Whether a mesh is a cloud whose points stand for spheres: it has the topology `points`, and its `surface` is the
/// sphere around each of them. Rays meet the spheres, and number them as primitives; cameras draw squares of their
/// size.
inline bool is_solid_cloud(const Mesh& mesh) {
  return mesh.topology == Topology::points && mesh.surface && mesh.surface->kind == SurfaceKind::sphere;
}

}  // namespace simvis
