#include "engine/draw/sky_sphere.h"

#include <cmath>
#include <numbers>

namespace simvis {

// With the elevation e and the azimuth a, the direction is (cos e cos a, cos e sin a, sin e) and the measure cos e.
SkySphere::SkySphere(std::uint32_t width_px, std::uint32_t height_px) : width_px_(width_px), height_px_(height_px) {
  const double wide_rad = 2 * std::numbers::pi / width_px;
  const auto integral_of_square = [](double e) { return e / 2 + std::sin(2 * e) / 4; };  // of the cosine's square
  for (std::uint32_t row = 0; row < height_px; ++row) {
    const double top = elevation_rad(row), bottom = elevation_rad(row + 1.0), high = std::sin(top),
                 low = std::sin(bottom);
    rows_.push_back({.solid_angle_sr = wide_rad * (high - low),
                     .across = integral_of_square(top) - integral_of_square(bottom),
                     .up = wide_rad * (high * high - low * low) / 2});
  }
  for (std::uint32_t column = 0; column < width_px; ++column) {
    const double left = azimuth_rad(column), right = azimuth_rad(column + 1.0);
    columns_.emplace_back(std::sin(left) - std::sin(right), std::cos(right) - std::cos(left));
  }
}

double SkySphere::azimuth_rad(double column) const { return std::numbers::pi * (1 - 2 * column / width_px_); }

double SkySphere::elevation_rad(double row) const { return std::numbers::pi * (0.5 - row / height_px_); }

glm::dvec3 SkySphere::direction_integral(std::uint32_t column, std::uint32_t row) const {
  return {rows_[row].across * columns_[column], rows_[row].up};
}

glm::dvec3 mean_radiance(const SkyPicture& picture) {
  const SkySphere sphere(picture);
  glm::dvec3 sum(0);
  for (std::uint32_t row = 0; row < picture.height; ++row) {
    glm::dvec3 of_row(0);
    for (std::uint32_t column = 0; column < picture.width; ++column) {
      of_row += glm::dvec3(picture.radiance[std::size_t{row} * picture.width + column]);
    }
    sum += sphere.solid_angle_sr(row) * of_row;
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace simvis
