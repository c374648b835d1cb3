// A camera's intrinsics as other programs read them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <simvis/frame_plan.h>

namespace simvis {

/// What is to be told of a camera.
struct CameraInfo {
  std::string name;
  std::uint32_t width_px = 0, height_px = 0;
  Pinhole pinhole;
  double baseline_m = 0;  ///< how far it stands to the right of the left camera of a rectified pair; 0: it is the left
  std::string_view distortion_model = "plumb_bob";             ///< as ROS names it
  std::vector<double> distortion_coefficients{0, 0, 0, 0, 0};  ///< in ROS's order: plumb_bob's is k1 k2 p1 p2 k3
};

/// A YAML file in the layout of ROS's camera_info, as camera_calibration_parsers reads it: no
/// rectification, P[3] = -fx * baseline; the projection is that of the distorted image, too.
///
/// Pixels   ROS and OpenCV count from the centre of the first pixel, a Pinhole from its corner: so cx and cy are half a
///          pixel less here.
std::string camera_info_yaml(const CameraInfo& info);

}  // namespace simvis
