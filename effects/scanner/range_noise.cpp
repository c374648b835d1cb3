// The effect `range_noise`: errors of the range of each beam, white noise and a constant bias.
//
// Bias     r' = r + u (range_bias + range_bias_rel r), with u uniform between -1 and 1, drawn once for each channel of
//          the device: the bounds that data sheets call accuracy.
// Noise    r' + g sqrt(range_noise^2 + (range_noise_rel r')^2), with g normally distributed, drawn for each
//          measurement. The two causes, the clock and the path, are independent, so their variances add up. The result
//          is rounded to float32 once.
// Special  A beam that hit nothing keeps its inf, a blocked beam its 0. A range that the errors would make negative
//          reads 0.
// Limits   range_min and range_max limit the surfaces that the scanner sees, not its readings: an error may move a
//          reading past either.
// Bound    error_bound_m refers to the range before the errors.
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
    {.name = "range_bias",
     .default_value = "0",
     .unit = "m",
     .text = "largest constant error of a channel, which is drawn once for each",
     .min = 0},
    {.name = "range_bias_rel",
     .default_value = "0",
     .text = "the same as a share of the range; the two bounds add up",
     .min = 0,
     .max = 1},
};

class RangeNoise : public ScanEffect {
 public:
  explicit RangeNoise(const ScanEffectContext& context)
      : sigma_m_(context.attributes.number("range_noise")),
        sigma_rel_(context.attributes.number("range_noise_rel")),
        bias_m_(context.attributes.number("range_bias")),
        bias_rel_(context.attributes.number("range_bias_rel")),
        random_(context.random("range_noise")),
        random_bias_(context.random("range_bias")) {}

  /// Returns true if one of the attributes is above 0.
  static bool has_errors(const AttributeValues& a) {
    return a.number("range_noise") > 0 || a.number("range_noise_rel") > 0 || a.number("range_bias") > 0 ||
           a.number("range_bias_rel") > 0;
  }

  void finish(const ScanContext& context, std::span<const Echo>, Scan& scan) const override {
    const std::span<float> ranges_m = scan.edit_ranges().range_m;
    for (std::uint32_t beam = 0; beam < ranges_m.size(); ++beam) {
      if (ranges_m[beam] == 0 || std::isinf(ranges_m[beam])) continue;
      const double range_m = biased_m(ranges_m[beam], scan.ring_of(beam));
      const double gaussian = has_noise_ ? random_.gaussian(random_key(context.time), beam, 0) : 0;
      ranges_m[beam] = static_cast<float>(noisy_range_m(range_m, sigma_m_, sigma_rel_, gaussian));
    }
  }

 private:
  double biased_m(double range_m, std::uint32_t channel) const {
    const double bound_m = bias_m_ + bias_rel_ * range_m;
    return bound_m == 0 ? range_m : range_m + bound_m * (2 * random_bias_.uniform(0, channel, 0) - 1);
  }

  double sigma_m_, sigma_rel_, bias_m_, bias_rel_;
  bool has_noise_ = sigma_m_ > 0 || sigma_rel_ > 0;
  SensorRandom random_, random_bias_;
};

const ScanEffectRegistration kRangeNoiseRegistration({
    .type = {.name = "range_noise",
             .summary = "Errors of the range: Gaussian noise of each measurement, and a constant bias of each channel.",
             .notes = "The error bound refers to the range before the errors. Ranges of 0 and inf stay as they are.",
             .source = "attribute range_noise, range_noise_rel, range_bias or range_bias_rel above 0",
             .outputs = kShownInRanges,
             .reference = "the normal distribution, by Box and Muller, Ann. Math. Statist. 29 (1958)",
             .needs = kCastsBeams,
             .attributes = kRangeNoiseAttributes},
    .order = ScanOrder::disturbance,
    .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
      if (!RangeNoise::has_errors(context.attributes)) return nullptr;
      return std::make_unique<RangeNoise>(context);
    },
});

}  // namespace
}  // namespace simvis
