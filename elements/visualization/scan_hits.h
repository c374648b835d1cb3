// Directions and hits of the beams of a scan.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>

#include <simvis/scan.h>

namespace simvis {

/// Calls `visit(origin_m, direction, range_m)` for every `every`-th beam of each ring, in the sensor frame. The range
/// along the ray is infinite if the beam hit nothing, and 0 if it was blocked closer than the minimum range.
template <typename Visit>
void for_each_beam(const Scan& scan, std::size_t every, const Visit& visit) {
  for (std::size_t ring = 0; ring < scan.rings; ++ring) {
    for (std::size_t beam = 0; beam < scan.beams; beam += every) {
      const std::size_t i = ring * scan.beams + beam;
      visit(scan.origin(i), scan.direction(i), static_cast<double>(scan.range_m[i]));
    }
  }
}

/// Returns whether a range is the measured range of a surface.
inline bool is_hit(double range_m) { return range_m > 0 && std::isfinite(range_m); }

}  // namespace simvis
