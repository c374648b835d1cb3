// The pixels of a SkyPicture as patches of the unit sphere, in the picture's frame.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/sky_picture.h>

namespace simvis {

/// Largest width of a picture in pixels; its height is half of that.
inline constexpr std::uint32_t kMaxSkyWidth_px = 8192;

/// Integrals over the pixels of a picture of this size.
class SkySphere {
 public:
  SkySphere(std::uint32_t width_px, std::uint32_t height_px);
  explicit SkySphere(const SkyPicture& picture) : SkySphere(picture.width, picture.height) {}

  double azimuth_rad(double column) const;  ///< of the left edge of a column
  double elevation_rad(double row) const;   ///< of the upper edge of a row
  double solid_angle_sr(std::uint32_t row) const { return rows_[row].solid_angle_sr; }  ///< of each pixel of the row
  /// The integral of the direction over a pixel.
  glm::dvec3 direction_integral(std::uint32_t column, std::uint32_t row) const;

 private:
  struct Row {
    double solid_angle_sr, across, up;  // factors of all pixels of the row
  };
  std::uint32_t width_px_, height_px_;
  std::vector<Row> rows_;
  std::vector<glm::dvec2> columns_;  // integrals of (cos, sin) of the azimuth
};

/// The mean radiance over the sphere.
glm::dvec3 mean_radiance(const SkyPicture& picture);

/// The linear RGB radiance where nothing is hit: of the picture of the sky its mean over the sphere.
inline glm::dvec3 mean_background(const DrawList& list) {
  return glm::dvec3(list.sky.picture ? list.sky.mean * list.sky.factor : list.environment.background);
}

}  // namespace simvis
