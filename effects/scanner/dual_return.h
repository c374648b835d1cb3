// The effect `dual_return`: a receiver that reports two returns of each beam.
//
//   <sensor type="laser_scanner" ... divergence="0.2" return="dual"/>
//
// Range    range_m is that of the strongest return. The second return is the last one, or the second strongest if the
//          strongest is the last, as in the scanners of Velodyne and Hesai.
// Channels "second_range_m" and "second_intensity", in 1/m^2; NaN, an empty cell, for a beam with one return. The
//          second range has noise of its own (`range_noise`, `range_noise_rel`) and the same rounding
//          (`range_resolution`). It has no bound, and range_min does not limit it.
// Reference  VLP-16 User Manual, 63-9243, section 9.3.2, dual return mode.
#pragma once

#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

/// The second return of a receiver with two, of echoes that are sorted by range; null if there are fewer than two.
const Echo* second_return(std::span<const Echo> echoes);

/// The columns of the second return.
inline constexpr const char* kSecondRange = "second_range_m";
inline constexpr const char* kSecondIntensity = "second_intensity";

class DualReturn : public ScanEffect {
 public:
  explicit DualReturn(const ScanEffectContext& context);

  bool traces() const override { return true; }
  /// Keeps the second return of the beam for finish(), and does not decide.
  bool detect(const ScanContext& context, std::uint32_t beam, std::span<const Echo> echoes,
              Echo& detected) const override;
  void finish(const ScanContext& context, std::span<const Echo> detected, Scan& scan) const override;

 private:
  double sigma_m_, sigma_rel_, step_m_;
  SensorRandom random_;
  mutable std::vector<Echo> second_;  // by beam, of the scan that is being taken
};

}  // namespace simvis
