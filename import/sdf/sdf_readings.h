// Sensors of SDF that give a row of numbers.
#pragma once

#include <optional>
#include <string>

#include "import/sdf/sdf_command.h"

namespace simvis {

/// Adds `pose_offset` and `rate` of a <sensor>.
void add_sdf_sensor_place(const SdfElement& sensor, const glm::dmat4& point_from_sensor, SdfCommand& command);

/// The sensor `imu`, `gnss` (navsat, gps), `magnetometer`, `barometer` (air_pressure), `altimeter` or `contact` of a
/// <sensor>, with its noise. A contact sensor is that of its whole link. `world` is the element whose <gravity> and
/// <spherical_coordinates> hold; it may be none. Empty: a sensor of another type. Throws InputError for wrong numbers.
std::optional<SdfCommand> sdf_reading_command(const SdfElement& sensor, const SdfElement& world, const SdfPlace& place,
                                              const glm::dmat4& point_from_sensor, ImportReport& report);

/// The sensor `force_torque` of a joint: the force of the child on the parent, along the axes of the child, about the
/// joint's origin. `point_from_child` turns these axes into those of the insertion point. What else <force_torque> says
/// is reported. Throws InputError for wrong numbers.
std::string sdf_force_torque_command(const SdfElement& sensor, const std::string& joint, const SdfPlace& place,
                                     const glm::dmat4& point_from_child, ImportReport& report);

}  // namespace simvis
