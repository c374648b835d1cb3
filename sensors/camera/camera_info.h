// Writes a camera's intrinsics as a ROS camera_info YAML file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <simvis/frame_plan.h>

namespace simvis {

/// The intrinsics of one camera.
struct CameraInfo {
  std::string name;
  std::uint32_t width_px = 0, height_px = 0;
  Pinhole pinhole;
  double baseline_m = 0;  ///< distance to the right of the left camera of a rectified pair; 0 for the left camera
  std::string_view distortion_model = "plumb_bob";             ///< name in ROS
  std::vector<double> distortion_coefficients{0, 0, 0, 0, 0};  ///< in the order of ROS; for plumb_bob k1 k2 p1 p2 k3
};

/// Returns a YAML file in the layout of ROS's camera_info, as camera_calibration_parsers reads it. There is no
/// rectification, and P[3] = -fx * baseline; the projection matrix is also that of the distorted image.
///
/// Pixels   ROS and OpenCV count from the centre of the first pixel, a Pinhole from its corner: cx and cy are half a
///          pixel less in the file.
std::string camera_info_yaml(const CameraInfo& info);

}  // namespace simvis
