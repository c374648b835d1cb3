// Meshes that an MJCF model has itself, or in MuJoCo's own old binary files.
#pragma once

#include <vector>

#include <simvis/mesh.h>
#include "import/mjcf/mjcf_element.h"

namespace simvis {

/// The mesh of the attributes `vertex` and `face`, without smoothing; without `face` the convex hull of the vertices.
/// Throws InputError for numbers that are no triples, faces of vertices that are not there, and vertices in one plane
/// without faces.
Mesh inline_mjcf_mesh(const MjcfElement& asset);

/// The convex hull of vertices that have no faces, without smoothing. Throws InputError at the asset for vertices in
/// one plane, and where they are so many that the hull takes too long.
Mesh mjcf_hull(const MjcfElement& asset, std::vector<glm::vec3> vertices);

/// A file .msh: the numbers of positions, normals, texture coordinates and triangles as 32-bit integers, then these, in
/// 32-bit numbers. Normals and texture coordinates belong to positions. Throws InputError naming the file for other
/// sizes than these numbers say, indices out of range, and positions that are not finite.
Mesh read_msh_file(const std::filesystem::path& file);

}  // namespace simvis
