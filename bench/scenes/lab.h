// Labs of any size: a room with boxes, spheres and cylinders on the floor, and a robot that drives between them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include <simvis/simulation.h>

namespace simvis::bench {

/// Writes a lab into `folder` and returns the path of its scene, lab.xml: a room of 16 x 12 x 3 m with up to 200 items,
/// each with its own mesh and together with nine tenths of the triangles. The number of triangles is approximate, as
/// each mesh is a grid: within a quarter at 1,000, the smallest number, and within some per cent from 10,000 on. The
/// result is deterministic.
///
/// Robot    a box, ROBOT, moved by the pose R_POSE: see drive_lab(). `sensors` is the XML of its sensors, by default
///          three scanners as in scenes/marvin: FRONT_SCANNER and REAR_SCANNER 0.1 m and TILT_SCANNER 1 m above the
///          floor, with 361 beams over a half circle each.
std::filesystem::path write_lab(const std::filesystem::path& folder, std::size_t triangles);
std::filesystem::path write_lab(const std::filesystem::path& folder, std::size_t triangles, const std::string& sensors);

/// Writes a lab of about 10,000 triangles, in which each wall has two, with `instances` of a box of 192 triangles. The
/// first 100 stand around the robot. The others lie in rows above the ceiling, where none of its scanners measures, and
/// ceiling and walls hide them from a camera.
std::filesystem::path write_store(const std::filesystem::path& folder, std::size_t instances);
std::filesystem::path write_store(const std::filesystem::path& folder, std::size_t instances,
                                  const std::string& sensors);

/// Sets R_POSE to the robot's pose in a frame: once around a circle of 1 m in 360 frames.
void drive_lab(Simulation& simulation, int frame);

/// The number of triangles of all items; each instance counts.
std::size_t triangles_of(const DrawList& list);

}  // namespace simvis::bench
