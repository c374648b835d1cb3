// Scenes of finely tessellated things that stand far away or reach far: where coarser levels may pay.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace simvis::bench {

/// Writes a hall with `robots` equal robots in rows, 8 to about 100 m in front of ROOT's camera along x, and returns
/// the path of its scene. A robot has six meshes as they come out of CAD, together 24,000 triangles, which all robots
/// share. `sensors` is the XML of the sensors.
std::filesystem::path write_fleet(const std::filesystem::path& folder, std::size_t robots, const std::string& sensors);

/// Writes a landscape of 400 x 400 m as scanned: one mesh of about `triangles`, with hills of some metres, 0 high at
/// the origin, and returns the path of its scene.
std::filesystem::path write_terrain(const std::filesystem::path& folder, std::size_t triangles,
                                    const std::string& sensors);

}  // namespace simvis::bench
