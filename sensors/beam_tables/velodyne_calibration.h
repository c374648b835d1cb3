// Beam tables from the calibration files of Velodyne devices, as the ROS package velodyne_pointcloud has them.
#pragma once

#include <filesystem>

#include "sensors/beam_tables/beam_table.h"
#include "sensors/beam_tables/table_columns.h"

namespace simvis {

/// Reads the keys and lists of YAML that such files have, in block or flow style: `lasers`, a list with laser_id,
/// rot_correction, vert_correction and optionally vert_offset_correction and horiz_offset_correction of each laser
/// (radians and metres), num_lasers and distance_resolution. Corrections of measured distances and intensities are for
/// drivers and change no beam.
///
/// The table has a ring for each laser, by increasing vert_correction, and the given columns. Beam and origin are those
/// of the driver: of a laser with the offsets v and h that points along azimuth a and elevation e, the beam starts at
/// v (-sin e cos a, -sin e sin a, cos e) + h (-sin a, cos a, 0).
///
/// Errors   InputError with the place: an unknown key, a value that is no number or out of range, a laser without one
///          of the three numbers or there twice, no lasers, or too many beams.
BeamTable read_velodyne_calibration(const std::filesystem::path& file, const TableColumns& columns);

}  // namespace simvis
