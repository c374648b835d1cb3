// Reads one primitive of a glTF mesh as an indexed list of triangles, lines or points.
#pragma once

#include <span>

#include <simvis/mesh.h>
#include "import/gltf/gltf_document.h"
#include "scenegraph/mesh_deformation.h"

namespace simvis {

/// A checked primitive. Every index is below the number of vertices.
struct GltfPrimitive {
  Mesh mesh;                 ///< attributes without normals have the default ones; bounds are not set yet; of splats
                             ///< nothing else is set
  bool has_normals = false;  ///< the file gives normals

  bool needs_flat_normals() const { return mesh.topology == Topology::triangles && !has_normals; }
};

/// Reads attributes and indices, and turns strips, fans and loops into lists.
/// Returns false if the primitive has no positions; glTF then draws nothing.
/// Throws InputError naming the file and the accessor.
bool read_primitive(GltfDocument& document, const tinygltf::Primitive& source, GltfPrimitive& primitive);

/// Reads the morph targets and joint influences that deform a primitive. `joints` is the number of joints of its skin,
/// or -1 without a skin. `weights` has one value per target or is empty. Only targets with a weight other than 0 are
/// read, or all targets if `weights_change`.
/// Throws InputError for targets that do not fit the primitive, and for joints that are missing, do not fit or are out
/// of range.
DeformableMesh read_deformable(GltfDocument& document, const tinygltf::Primitive& source, GltfPrimitive&& primitive,
                               std::span<const double> weights, bool weights_change, int joints);

}  // namespace simvis
