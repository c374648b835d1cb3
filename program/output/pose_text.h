// Poses as text: a CSV table, and the lines of the TUM format.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <string_view>

#include <simvis/frame_time.h>
#include "scenegraph/pose3.h"

namespace simvis {

inline constexpr std::string_view kPoseHeading = "frame,time_s,x_m,y_m,z_m,qx,qy,qz,qw\n";
inline constexpr std::string_view kTumHeading = "# time_s tx ty tz qx qy qz qw\n";

/// One line under kPoseHeading. Times have nine decimals; the other numbers read back to the same double.
std::string pose_line(const FrameTime& time, const glm::dmat4& matrix);

/// One line of TUM's format: time, position, quaternion, separated by spaces; numbers as in pose_line().
std::string tum_line(const FrameTime& time, const glm::dmat4& matrix);

}  // namespace simvis
