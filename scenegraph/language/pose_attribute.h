// The pose of a part or a sensor: pose_offset="x y z roll pitch yaw", or pose_offset="x y z" with quaternion="w x y z"
// or, for sensors, look_at.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include <simvis/command.h>

namespace simvis {

inline constexpr std::string_view kPoseOffset = "pose_offset", kQuaternion = "quaternion", kLookAt = "look_at";

/// The largest difference from 1 of the length of a quaternion. Four components that are rounded to three decimals
/// change the length by at most sqrt(4) * 0.0005. A quaternion within the tolerance is scaled to length 1.
inline constexpr double kQuaternionTolerance = 0.001;

/// Returns parent_from_child of the command: metres, and degrees or a quaternion; with `look_at`, the position alone.
/// Returns nothing if the command has neither pose_offset nor quaternion. Throws InputError at an attribute that has an
/// error or contradicts another one.
std::optional<glm::dmat4> pose_offset(const Command& command);

}  // namespace simvis
