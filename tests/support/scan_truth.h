// Compares scans with the double-precision ray cast.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <ostream>
#include <vector>

#include <simvis/scan.h>
#include "tests/support/reference_directions.h"
#include "tests/support/reference_raycast.h"

namespace simvis {

struct ScanComparison {
  std::size_t beams = 0;
  std::size_t uncertain = 0;            ///< infinite bound: the method does not say which surface is met
  std::size_t violations = 0;           ///< the truth lies outside the bound, and the surface met is wide enough
  std::size_t narrow = 0;               ///< the truth lies outside, on a surface that the bound does not speak of
  std::size_t wrong_surface = 0;        ///< relative error above 1e-3, or hit for miss, among the uncertain
  double worst_use = 0;                 ///< the largest error / bound among the certain
  std::vector<double> relative_errors;  ///< of beams where scan and truth both have a range
  std::vector<double> relative_bounds;  ///< of those with a finite bound

  static double quantile(std::vector<double> values, double q) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }
  double median_error() const { return quantile(relative_errors, 0.5); }
};

/// The reading of a scanner for this range.
inline double expected_reading(double range_m, double range_min_m, double range_max_m) {
  if (range_m < range_min_m) return 0;
  return range_m > range_max_m ? std::numeric_limits<double>::infinity() : range_m;
}

/// Whether the surface met at (azimuth, elevation) is less than three pixels wide, across or (for several rings) along
/// the elevation. It is followed in quarters of a pixel until the range departs from its plane.
inline bool is_narrow(const reference::RayCaster& truth, double azimuth, double elevation, bool rings,
                      double pixel_rad) {
  const reference::Hit hit = truth.cast(reference::beam_direction(azimuth, elevation));
  if (!std::isfinite(hit.range_m)) return false;
  for (int axis = 0; axis <= (rings ? 1 : 0); ++axis) {
    int quarters = 0;
    for (const int side : {-1, 1}) {
      for (int k = 1; k <= 12; ++k, ++quarters) {
        const double turn = side * k * pixel_rad / 4;
        const glm::dvec3 d =
            reference::beam_direction(azimuth + (axis == 0 ? turn : 0), elevation + (axis == 1 ? turn : 0));
        const double expected = truth.range_of_plane(hit.triangle, d);
        if (!(std::abs(truth.cast(d).range_m - expected) <= 1e-9 * std::abs(expected))) break;
      }
    }
    if (quarters < 12) return true;
  }
  return false;
}

/// `pixel_rad`: the widest pixel of the method, 2 / resolution.
inline void compare(const Scan& scan, const reference::RayCaster& truth, double range_min_m, double range_max_m,
                    double pixel_rad, ScanComparison& result) {
  for (std::uint32_t ring = 0; ring < scan.rings; ++ring) {
    const double e = scan.elevation_rad[ring];
    for (std::uint32_t beam = 0; beam < scan.beams; ++beam) {
      const double a = scan.azimuth_rad[beam];
      const glm::dvec3 direction = reference::beam_direction(a, e);
      const double expected = expected_reading(truth.cast(direction).range_m, range_min_m, range_max_m);
      const std::size_t index = std::size_t{ring} * scan.beams + beam;
      const double range = scan.range_m[index], bound = scan.error_bound_m[index];
      const bool same_kind = std::isfinite(expected) == std::isfinite(range);
      const double error = expected == range ? 0 : std::abs(range - expected);
      ++result.beams;
      result.uncertain += std::isinf(bound);
      if (!(error <= bound)) ++(is_narrow(truth, a, e, scan.rings > 1, pixel_rad) ? result.narrow : result.violations);
      if (std::isfinite(bound) && error > 0) result.worst_use = std::max(result.worst_use, error / bound);
      if (std::isinf(bound) && (!same_kind || error > 1e-3 * expected)) ++result.wrong_surface;
      if (same_kind && std::isfinite(expected) && expected > 0) {
        result.relative_errors.push_back(error / expected);
        if (std::isfinite(bound)) result.relative_bounds.push_back(bound / expected);
      }
    }
  }
}

inline std::ostream& operator<<(std::ostream& out, const ScanComparison& c) {
  const auto share = [&](std::size_t n) { return 100.0 * static_cast<double>(n) / static_cast<double>(c.beams); };
  return out << c.beams << " beams: relative error median " << c.median_error() << ", p99 "
             << ScanComparison::quantile(c.relative_errors, 0.99) << ", p99.9 "
             << ScanComparison::quantile(c.relative_errors, 0.999) << "; relative bound median "
             << ScanComparison::quantile(c.relative_bounds, 0.5) << ", error at most " << c.worst_use
             << " of the bound; violations " << c.violations << ", on surfaces under three pixels wide " << c.narrow
             << "; uncertain " << share(c.uncertain) << " % (of all, on the wrong surface " << share(c.wrong_surface)
             << " %)";
}

}  // namespace simvis
