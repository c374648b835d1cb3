// The effect `returns`: what a receiver makes of several echoes of one beam.
//
//   <sensor type="laser_scanner" ... divergence="0.2" return="last" pulse_length="0.75"/>
//
// A pulse of duration T is c T / 2 long in range. Echoes that follow one another more closely than that overlap: the
// receiver sees one pulse, and takes its middle. So two walls within a pulse's length give one range between them (a
// mixed pixel), two that are farther apart give two returns, and a slanted floor one long one. A single pulse has a
// bound that follows from those of its echoes: their largest, and what the echoes' powers may be off by, see
// merge_pulses().
//
// Without this effect, a beam of several echoes reports the strongest pulse of kPulseLength_m.
#pragma once

#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

/// Of a pulse of 5 ns, c T / 2.
inline constexpr double kPulseLength_m = 0.75;

/// `echoes` by range: those between which there is no gap of more than `pulse_length_m` become one, whose range is
/// their mean, weighted by power (evenly where none has any), and whose power is their sum.
///
/// Bound. Each range is off by at most e; as a mean, theirs by no more than the largest e. A weight is off by a share
/// of 2 e / range and 2^-24 of the reflectance, a float32; that moves the mean by no more than as great a share of the
/// echoes' spread. What lies between the echoes' rays the bound does not speak of.
void merge_pulses(double pulse_length_m, std::vector<Echo>& echoes);

enum class ReturnChoice : std::uint8_t { strongest, first, last };

class Returns : public ScanEffect {
 public:
  Returns(ReturnChoice choice, double pulse_length_m) : choice_(choice), pulse_length_m_(pulse_length_m) {}

  bool traces() const override { return true; }
  std::optional<double> pulse_length_m() const override { return pulse_length_m_; }
  bool detect(const ScanContext& moment, std::uint32_t beam, std::span<const Echo> echoes,
              Echo& detected) const override;

  /// Adds the channel "return_count": how many returns there are within range_max, 0 for none.
  void finish(const ScanContext& moment, std::span<const Echo> detected, Scan& scan) const override;

 private:
  ReturnChoice choice_;
  double pulse_length_m_;
};

}  // namespace simvis
