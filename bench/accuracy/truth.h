// The true readings of scans and the errors against them: every beam is cast in double (simvis/ray_caster.h, which the
// tests compare with a test of every triangle).
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <simvis/ray_caster.h>
#include <simvis/scan.h>

namespace simvis::bench {

/// The true hits of a scanner at its pose.
struct TrueScan {
  glm::dmat4 world_from_sensor{1.0};
  std::vector<glm::dvec2> angles_rad{};  ///< azimuth, elevation
  std::vector<glm::dvec3> directions{};  ///< sensor frame
  std::vector<RayHit> hits{};
};

class Truth {
 public:
  /// `list` must not change.
  explicit Truth(const DrawList& list);

  /// Casts the beams of `pattern`; its ranges are not used.
  TrueScan look(const glm::dmat4& world_from_sensor, const Scan& pattern);

  /// True if the surface that a beam hits is less than three pixels wide or, for a lidar, fills no square of three by
  /// three pixels that contains the beam. The bounds of rendered ranges do not cover such surfaces. The test samples in
  /// quarters of a pixel: ranges must stay on the plane of the surface; in a gap through which a beam hits nothing,
  /// nothing must be hit.
  bool is_narrow(const TrueScan& scan, std::size_t beam, bool lidar, double pixel_rad);

 private:
  const DrawList& list_;
  std::unique_ptr<RayCaster> caster_;
};

/// The errors of one variant over all its scans.
struct BeamErrors {
  std::size_t beams = 0;
  std::size_t wrong_hits = 0;          ///< a hit where the truth has none, or the reverse
  std::size_t violations = 0;          ///< the truth lies outside the bound, on a surface that the bound covers
  std::size_t narrow_violations = 0;   ///< the same on a surface less than three pixels wide
  std::vector<float> relative_errors;  ///< of beams with a true or a measured hit; infinite for a wrong hit
  std::vector<float> relative_bounds;  ///< of beams that read a range
};

/// Adds the errors of a scan. `bounds_m` is empty if the method has no bounds. `is_narrow(beam)` is called if a bound
/// is violated.
template <typename IsNarrow>
void add_errors(const TrueScan& truth, std::span<const float> ranges_m, std::span<const float> bounds_m,
                const IsNarrow& is_narrow, BeamErrors& errors) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t beam = 0; beam < ranges_m.size(); ++beam) {
    const double expected = truth.hits[beam].range_m, range = ranges_m[beam];
    const bool met = std::isfinite(expected), read = std::isfinite(range);
    const double error = expected == range ? 0 : std::abs(range - expected);
    ++errors.beams;
    errors.wrong_hits += met != read;
    if (met || read) errors.relative_errors.push_back(met && read ? static_cast<float>(error / expected) : kInfinity);
    if (bounds_m.empty()) continue;
    if (read) errors.relative_bounds.push_back(static_cast<float>(bounds_m[beam] / range));
    if (!(error <= bounds_m[beam])) ++(is_narrow(beam) ? errors.narrow_violations : errors.violations);
  }
}

/// The quantile `q` of `values`; NaN if they are empty. Reorders them.
double quantile(std::vector<float>& values, double q);

}  // namespace simvis::bench
