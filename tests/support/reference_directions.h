// Angles and directions for tests, written out independently of the library.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

namespace simvis {

inline constexpr double kPi = std::numbers::pi;

namespace reference {

/// The unit vector at this azimuth, counter-clockwise from +x about +z, and elevation above the plane z = 0.
inline glm::dvec3 beam_direction(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::sin(elevation_rad)};
}

}  // namespace reference
}  // namespace simvis
