// Subdivides the surfaces of a part into more triangles.
#pragma once

#include <filesystem>

namespace simvis::bench {

/// Reads a .glb file, subdivides every triangle into `parts` x `parts` equal ones and writes the result to `to`.
/// Positions lie on the old triangles except for rounding to float32, and both sides of a shared edge get the same
/// positions. Throws std::runtime_error if the file does not have the layout that scenes/gltf_writer.py writes.
void write_finer_part(const std::filesystem::path& from, const std::filesystem::path& to, int parts);

/// Writes scenes/marvin into `folder` with meshes about ten times as fine: marvin.xml, drive.csv and parts. Returns the
/// path of the scene. Parts of more than 2,000 triangles (the room, the chairs, the robot) are subdivided 4 x 4, others
/// 3 x 3.
std::filesystem::path write_finer_marvin(const std::filesystem::path& folder);

}  // namespace simvis::bench
