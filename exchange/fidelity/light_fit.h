// Fits the light that returns: intensity over range and angle, and lost beams over the light.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include <simvis/draw_list.h>
#include "exchange/fidelity/fitted_number.h"
#include "exchange/fidelity/least_squares.h"
#include "exchange/fidelity/scene_beams.h"
#include "exchange/packets/beam_recording.h"

namespace simvis {

/// The beam of the scene with a number of the recording.
using SceneBeamOf = std::function<SceneBeam(std::size_t)>;

/// reflectance cos t / range^2 of a beam, with the fog of the scene, as Echo::power; NaN of a retro-reflector.
double power_of(const SceneBeam& beam, const Medium& medium);

/// intensity = gain reflectance cos(t)^angle_exponent / range^range_exponent. The unknowns of `fit` are the logarithm
/// of the gain at kReferenceRange_m, and the exponents.
struct IntensityFit {
  LeastSquaresFit fit{};
  std::size_t saturated = 0;  ///< beams left out because their intensity is the largest that the device can say

  /// The intensity of a beam, with the fog of the scene.
  double at(const SceneBeam& beam, const Medium& medium) const;
};

inline constexpr double kReferenceRange_m = 1;

/// What the ranges leave open of the angles of a ring: standard deviations in radians.
struct RingDeviation {
  double azimuth_rad = 0, elevation_rad = 0;
};

/// A ring whose angles are off has other angles of incidence too: what `rings` leaves open goes into the intervals.
/// Empty if fewer than kMinIntensities beams have one. `used` says which beams read the surface of the scene.
inline constexpr std::size_t kMinIntensities = 50;
std::optional<IntensityFit> fit_intensity(const BeamRecording& recording, const SceneBeamOf& scene,
                                          const Medium& medium, const std::vector<bool>& used,
                                          const std::vector<RingDeviation>& rings);

/// Beams of nearly the same power.
struct LossBin {
  double power = 0;  ///< their mean
  double beams = 0, lost = 0;
};

/// The parameters of the effect `dropout`. `power` and `noise` are 0 if the weakest beams are lost no more often than
/// the others, and not determined if the weakest 2 % are lost in less than 60 % of all cases.
struct LossFit {
  FittedNumber chance{}, power{}, noise{};
  std::vector<LossBin> bins{};

  /// The probability that a beam of this power is lost.
  double at(double power) const;
};

/// `counted` says which beams should meet the surface of the scene.
LossFit fit_losses(const BeamRecording& recording, const SceneBeamOf& scene, const Medium& medium,
                   const std::vector<bool>& counted);

/// The interval of 95 % of a probability of which `hits` of `tries` are seen: E. B. Wilson, J. Am. Stat. Assoc. 22,
/// 1927.
FittedNumber wilson_interval(double hits, double tries);

}  // namespace simvis
