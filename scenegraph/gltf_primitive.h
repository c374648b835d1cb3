// One primitive of a glTF mesh as an indexed list of triangles, lines or points.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "engine/mesh.h"
#include "scenegraph/gltf_document.h"

namespace simvis {

/// A primitive, read and checked: every index is below the number of vertices.
struct GltfPrimitive {
  Mesh mesh;                 ///< attributes without normals have the default ones; bounds are not set yet
  bool has_normals = false;  ///< the file gives them
};

/// Reads attributes and indices, and turns strips, fans and loops into lists.
/// False when the primitive has no positions: glTF then draws nothing.
/// Throws InputError naming the file and the accessor.
bool read_primitive(GltfDocument& document, const tinygltf::Primitive& source, GltfPrimitive& primitive);

/// Adds the weighted morph targets. Throws InputError for targets that do not fit the primitive.
void apply_morph_targets(const GltfDocument& document, const tinygltf::Primitive& source,
                         std::span<const double> weights, GltfPrimitive& primitive);

/// Moves each vertex by the weighted sum of its joints' matrices (linear blend skinning).
/// Throws InputError for missing, ill-fitting or out-of-range joints and weights.
void apply_skin(GltfDocument& document, const tinygltf::Primitive& source, std::span<const glm::dmat4> joint_matrices,
                GltfPrimitive& primitive);

/// Gives each triangle vertices and a normal of its own.
void set_flat_normals(Mesh& mesh);

}  // namespace simvis
