// Directions to satellites in the sky of a test.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

namespace simvis::test {

/// A direction in the frame of a receiver: x east, y north, z up.
struct SkyPoint {
  double azimuth_deg, elevation_deg;  ///< clockwise from north

  glm::dvec3 along() const {
    const double a = glm::radians(azimuth_deg), e = glm::radians(elevation_deg);
    return {std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e)};
  }
};

}  // namespace simvis::test
