// The attribute pose_offset="x y z roll pitch yaw" of parts and sensors.
#pragma once

#include <optional>

#include "scenegraph/command.h"
#include "scenegraph/pose.h"

namespace simvis {

inline constexpr std::string_view kPoseOffset = "pose_offset";

/// The command's pose_offset: six finite numbers, metres and degrees. Nothing if it was not written.
/// Throws InputError at the attribute.
std::optional<Pose> pose_offset(const Command& command);

}  // namespace simvis
