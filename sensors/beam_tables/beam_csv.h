// Beam tables as CSV: ours and Livox's.
#pragma once

#include <filesystem>

#include "sensors/beam_tables/beam_table.h"

namespace simvis {

/// The first line names the columns, in any order: azimuth_deg and elevation_deg, and optionally x_m, y_m, z_m, r_m,
/// time_s and channel; every further line is one beam. r_m moves the beam's origin along (cos azimuth, sin azimuth, 0).
/// Livox's names are Time/s, Azimuth/deg and Zenith/deg (90 - elevation); if its times are the numbers of the beams, as
/// in the tables of livox_laser_simulation, the table has no times. Empty lines and lines that begin with # are
/// skipped.
///
/// Errors   InputError with the place: a column that is missing, unknown or there twice, a line with another number of
///          values, a value that is no number or out of range, no beams, or more than kMaxTableBeams.
BeamTable read_beam_csv(const std::filesystem::path& file);

}  // namespace simvis
