// The layout of a camera's image: the viewing ray of each pixel and the time of each row.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include <simvis/export.h>
#include <simvis/frame_plan.h>
#include <simvis/location.h>

namespace simvis {

/// When, through which points of the lens, and how large in each colour, an image is exposed. All else that a camera
/// measures is of the row's time and through the centre of the lens.
struct ColorExposure {
  double time_s = 0;          ///< the exposure begins this much before the row's time, and ends then; 0: an instant
  double aperture_m = 0;      ///< radius of the lens; 0: a pinhole
  double focus_m = 1;         ///< depth along Z at which the lens is sharp, above 0
  std::uint32_t samples = 1;  ///< images whose mean is taken, at times and points that fill the exposure evenly
  /// Of the pictures in red, green and blue about the optical axis, relative to that of the pinhole; each above 0.
  glm::dvec3 magnification{1};
  Location samples_at{},   ///< where their number was written, for messages
      aperture_at{},       ///< where the aperture was written
      magnification_at{};  ///< where a magnification was written

  /// Takes at least so many samples.
  void take(std::uint32_t least, const Location& at) {
    if (least <= samples) return;
    samples = least;
    samples_at = at;
  }
  /// Whether it is that of a pinhole at one time, the same in all colours.
  bool one_picture() const { return samples == 1 && time_s == 0 && aperture_m == 0 && magnification == glm::dvec3(1); }
};

/// The viewing ray of each pixel of an image and the time of each row.
///
/// Frames   V = view frame of the camera at the row's time: x right, y down, z forward.
/// Units    pixels, seconds.
struct SIMVIS_API CameraLayout {
  std::uint32_t width_px = 0,                                  ///< of the image
      height_px = 0;                                           ///< of the image
  Pinhole pinhole;                                             ///< fx, fy, cx, cy; given for a distorted image too
  std::string_view distortion_model = "plumb_bob";             ///< ROS name of the distortion model
  std::vector<double> distortion_coefficients{0, 0, 0, 0, 0};  ///< in the order of ROS
  /// [y * width_px + x], V, unit length, through the pixel's centre; zero: the pixel sees nothing. Empty: the rays of
  /// the pinhole.
  std::vector<glm::dvec3> rays{};
  /// With `rays`: the pixel position at which a vector of V is seen, whatever its length above 0, in the image or
  /// beyond its edges; empty if the lens does not show that direction. Null: the lens does not say.
  std::function<std::optional<glm::dvec2>(const glm::dvec3&)> pixel_of{};
  double oversampling = 1;          ///< with `rays`: rendered pixels per pixel of the image, at its centre
  Location oversampling_at{};       ///< where the oversampling was written, for messages
  double row_time_s = 0;            ///< time from one row to the next; the last row is taken at the frame's time
  ColorExposure exposure{};         ///< of colour
  std::uint32_t rows_per_pose = 1;  ///< with a row time: rows that share one pose, that of their middle

  /// Cosine of the angle between the optical axis and the viewing ray of a pixel. `x` and `y` are within the image. A
  /// pixel that sees nothing gives 0.
  double axis_cosine(std::uint32_t x, std::uint32_t y) const;

  /// The pixel position at which a vector of V is seen, which may lie beyond the edges of the image. Empty: nowhere, as
  /// behind a pinhole. A layout with rays must have `pixel_of` (asserted).
  std::optional<glm::dvec2> pixel(const glm::dvec3& point) const;
};

}  // namespace simvis
