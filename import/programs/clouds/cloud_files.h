// Files that hold points or splats and nothing else: PCD, LAS, SPZ, and PLY without faces.
#pragma once

#include <filesystem>

#include "import/programs/meshes/ply_file.h"
#include "import/sandbox/imported_scene.h"

namespace simvis {

/// PCD 0.5 to 0.7 of the Point Cloud Library: `DATA` ascii, binary and binary_compressed. Reads the fields x, y, z, and
/// rgb, rgba or intensity. The viewpoint is that of a sensor and moves no point.
/// Throws InputError naming the file, and the line of the header or of a point in text, for anything else.
ImportedScene read_pcd(const std::filesystem::path& file);

/// LAS 1.0 to 1.4 of the ASPRS, point formats 0 to 10. Reads the place, and the colour or the intensity. Throws
/// InputError naming the file for anything else, compressed LAZ included.
ImportedScene read_las(const std::filesystem::path& file);

/// SPZ of Niantic Labs, versions 2 to 4: Gaussian splats. Extensions are left out, with a warning. Throws InputError
/// naming the file for anything else.
ImportedScene read_spz(const std::filesystem::path& file);

/// Returns whether the only element is `vertex`, with x, y and z, no list and no opacity of points.
bool is_ply_of_points(const PlyFile& ply);

/// Reads such a file. Vertices with the properties of Gaussian splats are splats, see splat_columns.h. Throws
/// InputError naming the file, and the line in text, for a body that does not fit the header.
ImportedScene read_ply_points(const PartSource& source, const PlyFile& ply);

/// Returns whether it is a compressed PLY of SuperSplat, whose elements are `chunk`, `vertex` and maybe `sh`.
bool is_packed_ply(const PlyFile& ply);

/// Reads such a file: Gaussian splats. Harmonics of degree 1 and above are left out, with a warning. Throws InputError
/// naming the file for a body that does not fit the header.
ImportedScene read_packed_ply(const PartSource& source, const PlyFile& ply);

}  // namespace simvis
