// Sensors of SDF that give a row of numbers.
#pragma once

#include <optional>
#include <string>

#include "import/sdf/sdf_command.h"

namespace simvis {

/// Adds `pose_offset` and `rate` of a <sensor>.
void add_sdf_sensor_place(const SdfElement& sensor, const glm::dmat4& point_from_sensor, SdfCommand& command);

/// The sensor `imu`, `gnss` (navsat, gps), `magnetometer`, `barometer` (air_pressure) or `altimeter` of a <sensor>,
/// with its noise. `world` is the element whose <gravity> and <spherical_coordinates> hold; it may be none. Empty: a
/// sensor of another type. Throws InputError for wrong numbers.
std::optional<std::string> sdf_reading_command(const SdfElement& sensor, const SdfElement& world, const SdfPlace& place,
                                               const glm::dmat4& point_from_sensor, ImportReport& report);

}  // namespace simvis
