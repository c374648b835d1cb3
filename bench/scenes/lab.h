// Labs of any size: a room with boxes, spheres and cylinders on the floor, and a robot that drives among them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include <simvis/simulation.h>

namespace simvis::bench {

/// Writes a lab into `folder` and returns its scene, lab.xml. 16 x 12 x 3 m, up to 200 items, each a mesh of its own;
/// nine of ten triangles are theirs. The count is met as far as their grids allow, from 1,000 up: within a quarter
/// there, within some per cent from 10,000 on. Always the same.
///
/// Robot    a box, ROBOT, moved by the pose R_POSE: see drive_lab(). `sensors` is XML that stands below it, three
///          scanners as in scenes/marvin unless something else is given: FRONT_SCANNER and REAR_SCANNER 0.1 m and
///          TILT_SCANNER 1 m above the floor, 361 beams over a half circle each.
std::filesystem::path write_lab(const std::filesystem::path& folder, std::size_t triangles);
std::filesystem::path write_lab(const std::filesystem::path& folder, std::size_t triangles, const std::string& sensors);

/// Writes a lab of about 10,000 triangles, of which each wall takes two, with `instances` of a box of 192 triangles:
/// the first 100 stand around the robot, the others lie in rows above the ceiling, where none of its scanners looks and
/// a camera would see them but for ceiling and walls.
std::filesystem::path write_store(const std::filesystem::path& folder, std::size_t instances);
std::filesystem::path write_store(const std::filesystem::path& folder, std::size_t instances,
                                  const std::string& sensors);

/// Sets R_POSE to where the robot is in a frame: once around a circle of 1 m in 360 frames.
void drive_lab(Simulation& simulation, int frame);

/// Of all items, instances counted each.
std::size_t triangles_of(const DrawList& list);

}  // namespace simvis::bench
