// Where the pixels of a sensor look that casts rays of its own through a pinhole or a lens, and what its measurements
// say of it.
//
// Frames   V = view frame of the sensor: x right, y down, z forward.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/frame_time.h>
#include <simvis/measurement.h>

namespace simvis {

/// When and from where a sensor measures.
struct SensorMoment {
  FrameTime time{};
  glm::dmat4 world_from_sensor{1.0};
};

/// The square of a pixel to first order, seen as the image of one pixel behind a pinhole of its own.
struct PixelSquare {
  /// The frame of that pinhole, whose z axis is the ray through the pixel's centre. Its x and y axes are such that the
  /// square has sides of 1 / focal_px at z = 1, and no length across the ray becomes larger.
  glm::dmat3 square_from_view{1.0};
  double focal_px = 0;  ///< 0: the pixel sees nothing
  double near_m = 0;    ///< what is nearer along z is not seen
};

/// Rays through one point of each pixel. Pixels that see nothing there have none.
struct PixelFan {
  std::vector<std::uint32_t> pixels{};
  std::vector<glm::dvec3> directions{};  ///< V, unit length, by ray
  std::vector<double> near_m{};          ///< what is nearer is not seen, by ray
};

class PixelOptics {
 public:
  /// `sensor` names the sensor in messages. Throws InputError if an effect sets times of rows or an exposure, or does
  /// not say where its lens shows a direction.
  PixelOptics(const std::string& sensor, CameraLayout layout, double near_m);

  const CameraLayout& layout() const { return layout_; }
  bool has_lens() const { return !layout_.rays.empty(); }
  std::size_t pixels() const { return std::size_t{layout_.width_px} * layout_.height_px; }

  /// The ray through a point of a pixel, `offset_px` from its centre: V, unit length; zero: it sees nothing.
  glm::dvec3 direction(std::uint32_t pixel, const glm::dvec2& offset_px = glm::dvec2(0)) const;
  /// What is nearer along this ray (V, unit length) is not seen.
  double near_range_m(const glm::dvec3& direction) const;
  /// Whether a point of V is in the image and not too near, if nothing hides it.
  bool shows(const glm::dvec3& point_m) const;
  /// The fans through so many points of the pixels' squares: a regular grid, so the number is a square. The rays are in
  /// the order of `pixels`. Through a lens they take long to compute, and they are the same in all frames.
  std::vector<PixelFan> footprint(std::uint32_t rays, std::span<const std::uint32_t> pixels) const;
  /// Through a lens.
  PixelSquare square(std::uint32_t pixel) const;

  /// A measurement without arrays.
  Measurement measurement(const SensorMoment& of) const;
  const std::shared_ptr<const std::vector<Calibration>>& calibrations() const { return calibrations_; }

 private:
  CameraLayout layout_;
  double near_m_;
  bool is_wide_ = false;  // the images of cameras with this lens are made of several views
  std::shared_ptr<const std::vector<Calibration>> calibrations_;
};

}  // namespace simvis
