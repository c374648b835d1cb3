// Images that cameras produce.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <simvis/frame_plan.h>
#include <simvis/shared_array.h>

namespace simvis {

/// An image in host memory. Its copies share the numbers.
///
/// Shape    rows from the top; pixels[(y * width + x) * channels + c].
/// Units    colour: 4 channels, linear RGB radiance and alpha (always 1). Depth: 1 channel, depth along Z (the optical
///          axis) in metres, not range along the ray; +infinity where nothing is hit.
struct Image {
  std::uint32_t width = 0,    ///< in pixels
      height = 0,             ///< in pixels
      channels = 0;           ///< numbers per pixel
  SharedArray<float> pixels;  ///< width * height * channels numbers
};

/// The calibration of the camera that took an image.
struct CameraCalibration {
  std::uint32_t width_px = 0,  ///< of the images
      height_px = 0;           ///< of the images
  Pinhole pinhole;             ///< pixel centres are at halves; given for a distorted image too
  double baseline_m = 0;       ///< distance to the right of the left camera of a rectified pair; 0 for the left camera
  std::string distortion_model = "plumb_bob";                  ///< name in ROS
  std::vector<double> distortion_coefficients{0, 0, 0, 0, 0};  ///< in the order of ROS; for plumb_bob k1 k2 p1 p2 k3
};

}  // namespace simvis
