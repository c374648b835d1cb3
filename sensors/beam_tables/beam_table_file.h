// Reads beam tables from files in the forms in which users have them.
//
//   .csv      our table, see docs/beam-tables.md, or that of Livox: Time/s, Azimuth/deg, Zenith/deg
//   .mat3x4f  RGL's: one matrix of 3 x 4 float32 for each beam, row by row, little-endian
//   .json     Ouster's metadata of a sensor
//   .yaml     Velodyne's calibration as velodyne_pointcloud reads it; also .yml
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "sensors/beam_tables/beam_table.h"
#include "sensors/beam_tables/table_columns.h"

namespace simvis {

/// Whether the file describes the lasers of a column only, and needs TableColumns.
bool needs_columns(const std::filesystem::path& file);

/// Reads the file by its extension; `columns` are used if needs_columns(). `beams_per_second`, if given, takes the
/// place of the times of a file.
///
/// Errors   InputError with the place in the file: what was seen and what is allowed; also if the file cannot be read.
BeamTable read_beam_table(const std::filesystem::path& file, const TableColumns& columns,
                          std::optional<double> beams_per_second);

}  // namespace simvis
