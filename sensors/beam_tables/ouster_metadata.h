// Beam tables from the metadata that an Ouster sensor writes of itself.
#pragma once

#include <filesystem>
#include <memory>

#include "sensors/beam_tables/beam_table.h"

namespace simvis {

/// The table has one ring for each pixel of a column, in the device's order, and one beam for each column of the window
/// that the device measures, in the order of time; it is in the device's sensor frame. `device` is set.
///
/// Reads both forms, with all keys at the top (firmware up to 2.x) and in groups: beam_altitude_angles,
/// beam_azimuth_angles, lidar_mode, columns_per_frame, column_window, and if they are there beam_to_lidar_transform or
/// lidar_origin_to_beam_origin_mm, lidar_to_sensor_transform and prod_line.
///
/// Errors   InputError with the place in the file: no JSON, a key that is missing, a value of another type or out of
///          range, counts that differ.
BeamTable read_ouster_metadata(const std::filesystem::path& file);

/// The beams of a device with these numbers, which must be within the limits of a BeamTable.
BeamTable ouster_beam_table(const std::shared_ptr<const ScannerDevice>& device, std::uint32_t beams);

}  // namespace simvis
