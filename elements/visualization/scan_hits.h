// Directions and hits of the beams of a scan.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>

#include <simvis/scan.h>

namespace simvis {

/// Returns the direction of a beam as a unit vector in the sensor frame.
inline glm::dvec3 beam_direction(const Scan& scan, std::size_t ring, std::size_t beam) {
  return beam_direction(scan.azimuth_rad[beam], scan.elevation_rad[ring]);
}

/// Calls `visit(direction, range_m)` for every `every`-th beam of each ring. The range along the ray is infinite if the
/// beam hit nothing, and 0 if it was blocked closer than the minimum range.
template <typename Visit>
void for_each_beam(const Scan& scan, std::size_t every, const Visit& visit) {
  for (std::size_t ring = 0; ring < scan.rings; ++ring) {
    for (std::size_t beam = 0; beam < scan.beams; beam += every) {
      visit(beam_direction(scan, ring, beam), static_cast<double>(scan.range_m[ring * scan.beams + beam]));
    }
  }
}

/// Returns whether a range is the measured range of a surface.
inline bool is_hit(double range_m) { return range_m > 0 && std::isfinite(range_m); }

}  // namespace simvis
