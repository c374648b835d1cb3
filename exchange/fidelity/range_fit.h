// Fits angles, bias and pose to recorded ranges, and noise to what is left.
#pragma once

#include <cstdint>
#include <vector>

#include "exchange/fidelity/least_squares.h"
#include "exchange/fidelity/scene_beams.h"
#include "exchange/packets/beam_recording.h"

namespace simvis {

/// The standard deviation of angles that is assumed before the fit, in radians: 2 degrees, far above the error of any
/// scanner.
inline constexpr double kPriorAngle_rad = 0.035;

/// The largest number of rings whose angles are fitted.
inline constexpr std::uint32_t kMaxFittedRings = 256;

/// The variance of ranges: constant_m2 + share2 range^2 + angle_rad2 slope^2.
struct RangeVariance {
  double constant_m2 = 0, share2 = 0, angle_rad2 = 0;

  /// The variance in m^2 at a range, for a slope in metres per radian; at least that of a deviation of 10 micrometres.
  double at(double range_m, double slope_m) const;
};

struct RangeFit {
  double bias_m = 0;
  BeamCorrections corrections{};
  LeastSquaresFit angles{},  ///< bias, then position, roll and pitch if the pose is fitted, then two for each ring
      noise{};               ///< the three of RangeVariance
  RangeVariance variance{};
  std::vector<double> residual_m{};  ///< by beam; NaN: it is not used
  std::uint32_t rings = 0;           ///< whose angles are fitted; 0: more than kMaxFittedRings
};

/// The index of the first ring's azimuth in RangeFit::angles.
constexpr std::uint32_t first_ring_unknown(bool fit_pose) { return fit_pose ? 6 : 1; }

/// How fast the range of a beam changes with its angles, in metres per radian.
double slope_of(const SceneBeam& beam);

/// Errors of beams of one ring with the same number may depend on each other.
std::uint32_t azimuth_cluster(double azimuth_rad);

/// The beams of `recording` are sorted by ring, and in each ring by azimuth_cluster(). Casts them several times;
/// afterwards `scene` has the corrected beams.
RangeFit fit_ranges(const BeamRecording& recording, SceneBeams& scene, bool fit_pose);

}  // namespace simvis
