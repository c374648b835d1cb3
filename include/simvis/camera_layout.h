// Where and when the pixels of a camera's image look.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include <simvis/frame_plan.h>
#include <simvis/location.h>

namespace simvis {

/// Where and when the pixels of an image look.
///
/// Frames   V = view frame: x right, y down, z forward, of the camera at the row's time.
struct CameraLayout {
  std::uint32_t width_px = 0, height_px = 0;
  Pinhole pinhole;                                             ///< fx, fy, cx, cy, also those of a distorted image
  std::string_view distortion_model = "plumb_bob";             ///< as ROS names it
  std::vector<double> distortion_coefficients{0, 0, 0, 0, 0};  ///< in ROS's order
  /// [y * width + x], V, unit length, through the pixel's centre; zero: the pixel sees nothing. Empty: the pinhole's.
  std::vector<glm::dvec3> rays{};
  double oversampling = 1;          ///< with rays: pixels rendered per pixel of the image, in its middle
  Location oversampling_at{};       ///< where that was written, for messages
  double row_time_s = 0;            ///< from one row to the next; the last one is taken at the frame's time
  std::uint32_t rows_per_pose = 1;  ///< with a row time: rows that share a pose, that of their middle

  /// Cosine of the angle between the optical axis and what a pixel looks at.
  double axis_cosine(std::uint32_t x, std::uint32_t y) const;
};

}  // namespace simvis
