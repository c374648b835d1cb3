// The effect `range_noise`: independent Gaussian noise with mean 0 on the range of each beam.
//
// Law      range_m + g sqrt(range_noise^2 + (range_noise_rel range_m)^2), with g normally distributed. The two causes,
//          the clock and the path, are independent, so their variances add up. The result is rounded to float32 once.
// Special  A beam that hit nothing keeps its inf, a blocked beam its 0. A range that the noise would make negative
//          reads 0.
// Limits   range_min and range_max limit the surfaces that the scanner sees, not its readings: noise may move a reading
//          past either.
// Bound    error_bound_m refers to the range before the noise.
#include <cmath>

#include <simvis/scan_effect.h>
#include "effects/scanner/range_law.h"

namespace simvis {
namespace {

constexpr AttributeSpec kRangeNoiseAttributes[] = {
    {.name = "range_noise", .default_value = "0", .unit = "m", .text = "standard deviation of the range", .min = 0},
    {.name = "range_noise_rel",
     .default_value = "0",
     .text = "standard deviation as a share of the range; the two variances add up",
     .min = 0},
};

class RangeNoise : public ScanEffect {
 public:
  explicit RangeNoise(const ScanEffectContext& context)
      : sigma_m_(context.attributes.number("range_noise")),
        sigma_rel_(context.attributes.number("range_noise_rel")),
        random_(context.random("range_noise")) {}

  void finish(const ScanContext& context, std::span<const Echo>, Scan& scan) const override {
    const std::span<float> ranges_m = scan.edit_ranges().range_m;
    for (std::uint32_t beam = 0; beam < ranges_m.size(); ++beam) {
      const double range_m = ranges_m[beam];
      if (range_m == 0 || std::isinf(range_m)) continue;
      const double gaussian = random_.gaussian(random_key(context.time), beam, 0);
      ranges_m[beam] = static_cast<float>(noisy_range_m(range_m, sigma_m_, sigma_rel_, gaussian));
    }
  }

 private:
  double sigma_m_, sigma_rel_;
  SensorRandom random_;
};

const ScanEffectRegistration kRangeNoiseRegistration({
    .type = {.name = "range_noise",
             .summary = "Gaussian noise of the range, absolute and relative.",
             .notes = "The error bound refers to the range before noise. Ranges of 0 and inf stay as they are.",
             .source = "attribute range_noise or range_noise_rel above 0",
             .outputs = kShownInRanges,
             .reference = "the normal distribution, by Box and Muller, Ann. Math. Statist. 29 (1958)",
             .needs = kCastsBeams,
             .attributes = kRangeNoiseAttributes},
    .order = ScanOrder::disturbance,
    .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
      const AttributeValues& a = context.attributes;
      if (a.number("range_noise") == 0 && a.number("range_noise_rel") == 0) return nullptr;
      return std::make_unique<RangeNoise>(context);
    },
});

}  // namespace
}  // namespace simvis
