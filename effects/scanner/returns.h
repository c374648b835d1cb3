// The effect `returns`: how a receiver combines several echoes of one beam.
//
//   <sensor type="laser_scanner" ... divergence="0.2" return="last" pulse_length="0.75"/>
//
// A pulse of duration T has the length c T / 2 in range. Echoes that are closer together than that overlap: the
// receiver sees one pulse and reports its middle. Two walls within a pulse length therefore give one range between them
// (a mixed pixel), two walls farther apart give two returns, and a slanted floor gives one long return. The bound of a
// pulse follows from those of its echoes: the largest bound plus the effect of errors in the powers, see
// merge_pulses().
//
// Without this effect, a beam with several echoes reports the strongest pulse of kPulseLength_m.
#pragma once

#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

/// Length in range of a pulse of 5 ns, c T / 2.
inline constexpr double kPulseLength_m = 0.75;

/// Merges echoes into pulses. `echoes` are sorted by range. Echoes with no gap of more than `pulse_length_m` between
/// them become one echo: its range is their mean weighted by power (with equal weights if all powers are 0), and its
/// power is their sum.
///
/// Bound: each range is off by at most its bound e, and a mean of ranges by at most the largest e. A weight has a
/// relative error of 2 e / range plus 2^-24 from the reflectance, which is a float32. This moves the mean by at most
/// the same share of the spread of the echoes.
///
/// Rays that stand for cones are samples of the light in them. The range of the light itself is then a mean over parts
/// of the beam, in each of which a flat surface is at most within_cone_m farther or nearer than at the ray: it differs
/// from the mean of the samples by at most their spread and the largest within_cone_m. The bound does not cover objects
/// that no ray meets, nor surfaces that bend or end within the cone of a ray by more than a plane does.
void merge_pulses(double pulse_length_m, std::vector<Echo>& echoes);

enum class ReturnChoice : std::uint8_t { strongest, first, last };

class Returns : public ScanEffect {
 public:
  Returns(ReturnChoice choice, double pulse_length_m) : choice_(choice), pulse_length_m_(pulse_length_m) {}

  bool traces() const override { return true; }
  std::optional<double> pulse_length_m() const override { return pulse_length_m_; }
  bool detect(const ScanContext& context, std::uint32_t beam, std::span<const Echo> echoes,
              Echo& detected) const override;

  /// Adds the channel "return_count": the number of returns within range_max, 0 if there is none.
  void finish(const ScanContext& context, std::span<const Echo> detected, Scan& scan) const override;

 private:
  ReturnChoice choice_;
  double pulse_length_m_;
};

}  // namespace simvis
