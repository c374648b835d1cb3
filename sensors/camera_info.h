// A camera's intrinsics as other programs read them.
#pragma once

#include <string>

#include "engine/frame_plan.h"

namespace simvis {

/// What is to be told of an ideal camera.
struct CameraInfo {
  std::string name;
  std::uint32_t width_px = 0, height_px = 0;
  Pinhole pinhole;
  double baseline_m = 0;  ///< how far it stands to the right of the left camera of a rectified pair; 0: it is the left
};

/// A YAML file in the layout of ROS's camera_info, as camera_calibration_parsers reads it: no distortion, no
/// rectification, P[3] = -fx * baseline.
///
/// Pixels   ROS and OpenCV count from the centre of the first pixel, a Pinhole from its corner: so cx and cy are half a
///          pixel less here.
std::string camera_info_yaml(const CameraInfo& info);

}  // namespace simvis
