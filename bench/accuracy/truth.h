// What scans should have read: every beam cast in double (engine/ray_caster.h, which the tests hold against a test of
// every triangle), and how far readings are off.
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

/// What a scanner meets where it stands.
struct TrueScan {
  glm::dmat4 world_from_sensor{1.0};
  std::vector<glm::dvec2> angles_rad{};  ///< azimuth, elevation
  std::vector<glm::dvec3> directions{};  ///< sensor frame
  std::vector<RayHit> hits{};
};

class Truth {
 public:
  /// `list` must stay as it is.
  explicit Truth(const DrawList& list);

  /// Of the beams of `pattern`, a scan whatever its ranges.
  TrueScan look(const glm::dmat4& world_from_sensor, const Scan& pattern);

  /// Whether what a beam meets is less than three pixels wide, or of a lidar fills no square of three by three pixels
  /// that holds the beam: of such the bounds of rendered ranges do not speak. Looked at in quarters of a pixel: whether
  /// ranges stay on the plane of the surface; of a gap through which a beam meets nothing, whether nothing is met.
  bool is_narrow(const TrueScan& scan, std::size_t beam, bool lidar, double pixel_rad);

 private:
  const DrawList& list_;
  std::unique_ptr<RayCaster> caster_;
};

/// Of one variant, over all its scans.
struct BeamErrors {
  std::size_t beams = 0;
  std::size_t wrong_hits = 0;          ///< something met where nothing is, or the reverse
  std::size_t violations = 0;          ///< the truth lies outside the bound, on a surface that it speaks of
  std::size_t narrow_violations = 0;   ///< outside, on a surface under three pixels wide
  std::vector<float> relative_errors;  ///< of beams that meet something, truly or as read; a wrong hit: infinite
  std::vector<float> relative_bounds;  ///< of beams that read a range
};

/// Adds a scan's errors. An empty `bounds_m`: the method gives none. `is_narrow(beam)` is asked where a bound is
/// broken.
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

/// The value that the share `q` of `values` does not exceed; NaN of nothing. Reorders them.
double quantile(std::vector<float>& values, double q);

}  // namespace simvis::bench
