// Writes a camera's intrinsics as a ROS camera_info YAML file.
#pragma once

#include <string>

#include <simvis/image.h>

namespace simvis {

/// Returns a YAML file in the layout of ROS's camera_info, as camera_calibration_parsers reads it. There is no
/// rectification, and P[3] = -fx * baseline; the projection matrix is also that of the distorted image.
///
/// Pixels   ROS and OpenCV count from the centre of the first pixel, a Pinhole from its corner: cx and cy are half a
///          pixel less in the file.
std::string camera_info_yaml(const std::string& name, const CameraCalibration& calibration);

}  // namespace simvis
