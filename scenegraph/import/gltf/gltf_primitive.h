// One primitive of a glTF mesh as an indexed list of triangles, lines or points.
#pragma once

#include <span>

#include <simvis/mesh.h>
#include "scenegraph/import/gltf/gltf_document.h"
#include "scenegraph/mesh_deformation.h"

namespace simvis {

/// A primitive, read and checked: every index is below the number of vertices.
struct GltfPrimitive {
  Mesh mesh;                 ///< attributes without normals have the default ones; bounds are not set yet
  bool has_normals = false;  ///< the file gives them

  bool needs_flat_normals() const { return mesh.topology == Topology::triangles && !has_normals; }
};

/// Reads attributes and indices, and turns strips, fans and loops into lists.
/// False when the primitive has no positions: glTF then draws nothing.
/// Throws InputError naming the file and the accessor.
bool read_primitive(GltfDocument& document, const tinygltf::Primitive& source, GltfPrimitive& primitive);

/// What morph targets and joints need to deform a primitive. `joints`: of its skin, -1 where it has none. A target is
/// read only where `weights` (one per target, or none) give it one, or all if they are going to change.
/// Throws InputError for targets that do not fit the primitive, for missing, ill-fitting or out-of-range joints.
DeformableMesh read_deformable(GltfDocument& document, const tinygltf::Primitive& source, GltfPrimitive&& primitive,
                               std::span<const double> weights, bool weights_change, int joints);

}  // namespace simvis
