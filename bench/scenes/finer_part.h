// The same surfaces, cut into more triangles.
#pragma once

#include <filesystem>

namespace simvis::bench {

/// Reads a .glb file of which every triangle is then cut into `parts` x `parts` equal ones, and writes it as `to`.
/// Positions lie on the old triangles but for the rounding to float32, and on a shared edge they are the same from
/// either side. Throws std::runtime_error where the file is not as scenes/gltf_writer.py writes it.
void write_finer_part(const std::filesystem::path& from, const std::filesystem::path& to, int parts);

/// Writes scenes/marvin into `folder` with meshes about ten times as fine: marvin.xml, drive.csv and parts. Returns the
/// scene. Parts of more than 2,000 triangles (the room, the chairs, the robot) are cut 4 x 4, others 3 x 3.
std::filesystem::path write_finer_marvin(const std::filesystem::path& folder);

}  // namespace simvis::bench
