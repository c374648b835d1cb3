// Directions and hits of the beams of a scan.
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include <simvis/scan.h>

namespace simvis {

/// The directions of a scan's beams, as Scan::direction(), with the sines and cosines of each azimuth and elevation of
/// an even grid computed once. It refers to the scan.
class BeamDirections {
 public:
  explicit BeamDirections(const Scan& scan) : scan_(scan) {
    if (scan.azimuth_rad.size() != scan.beams || scan.elevation_rad.size() != scan.rings) return;
    for (const double azimuth_rad : scan.azimuth_rad) turns_.emplace_back(std::cos(azimuth_rad), std::sin(azimuth_rad));
    for (const double angle_rad : scan.elevation_rad) tilts_.emplace_back(std::cos(angle_rad), std::sin(angle_rad));
  }

  glm::dvec3 of(std::size_t ring, std::size_t beam) const {
    if (turns_.empty()) return scan_.direction(ring * scan_.beams + beam);
    return {tilts_[ring].x * turns_[beam].x, tilts_[ring].x * turns_[beam].y, tilts_[ring].y};
  }

 private:
  const Scan& scan_;
  std::vector<glm::dvec2> turns_, tilts_;  // cosine and sine; empty for a beam table
};

/// Calls `visit(origin_m, direction, range_m)` for every `every`-th beam of each ring, in the sensor frame. The range
/// along the ray is infinite if the beam hit nothing, and 0 if it was blocked closer than the minimum range.
template <typename Visit>
void for_each_beam(const Scan& scan, std::size_t every, const Visit& visit) {
  const BeamDirections directions(scan);
  for (std::size_t ring = 0; ring < scan.rings; ++ring) {
    for (std::size_t beam = 0; beam < scan.beams; beam += every) {
      const std::size_t i = ring * scan.beams + beam;
      visit(scan.origin(i), directions.of(ring, beam), static_cast<double>(scan.range_m[i]));
    }
  }
}

/// Returns whether a range is the measured range of a surface.
inline bool is_hit(double range_m) { return range_m > 0 && std::isfinite(range_m); }

}  // namespace simvis
