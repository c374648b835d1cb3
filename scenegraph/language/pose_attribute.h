// The attribute pose_offset="x y z roll pitch yaw" of parts and sensors.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include <simvis/command.h>

namespace simvis {

inline constexpr std::string_view kPoseOffset = "pose_offset";

/// Returns parent_from_child of the command's pose_offset: six finite numbers in metres and degrees. Returns nothing if
/// the command has no pose_offset. Throws InputError at the attribute if it has an error.
std::optional<glm::dmat4> pose_offset(const Command& command);

}  // namespace simvis
