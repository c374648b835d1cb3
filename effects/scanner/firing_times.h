// When the beams of a scan leave, by the attributes `sweep`, `sweep_direction` and `firing` of the effect
// `sweep_motion`.
#pragma once

#include <simvis/scan_effect.h>

namespace simvis {

struct FiringTimes {
  double sweep_s = 0;  ///< from the first azimuth to the last
  bool clockwise = false;
  bool by_table = false;  ///< beams leave at the times of the scanner's beam table: ScanContext::firing_age_s

  FiringTimes(double sweep, bool is_clockwise) : sweep_s(sweep), clockwise(is_clockwise) {}
  explicit FiringTimes(const AttributeValues& a)
      : sweep_s(a.number("sweep")),
        clockwise(a.choice("sweep_direction") == "cw"),
        by_table(a.choice("firing") == "pattern") {}

  /// Whether all beams leave at the time of the frame.
  bool together() const { return !by_table && sweep_s == 0; }

  /// How long before the frame's time the beam leaves.
  double age_s(const ScanContext& context, std::uint32_t beam) const {
    if (by_table) return context.firing_age_s[beam];
    const std::uint32_t beams = context.beams, in_ring = beam % beams;
    const std::uint32_t after = clockwise ? in_ring : beams - 1 - in_ring;
    return beams == 1 ? 0 : sweep_s * after / (beams - 1);
  }
};

}  // namespace simvis
