// The effect `range_resolution`: rounds ranges to multiples of a step.
//
// Law      The nearest multiple of the step, halves rounded up; stored as the float32 nearest to that multiple.
// Special  0 and inf stay. A range below half a step reads 0.
// Bound    error_bound_m grows by the distance that rounding moved the range, so it still holds without noise.
#include <cmath>
#include <limits>

#include <simvis/scan_effect.h>
#include "effects/scanner/range_law.h"

namespace simvis {
namespace {

constexpr AttributeSpec kRangeResolutionAttributes[] = {
    {.name = "range_resolution",
     .default_value = "0",
     .unit = "m",
     .text = "ranges are rounded to multiples of this; 0: no rounding",
     .min = 0},
};

class RangeResolution : public ScanEffect {
 public:
  explicit RangeResolution(double step_m) : step_m_(step_m) {}

  void finish(const ScanContext&, std::span<const Echo>, Scan& scan) const override {
    const auto [ranges_m, bounds_m] = scan.edit_ranges();
    for (std::size_t beam = 0; beam < ranges_m.size(); ++beam) {
      const double range_m = ranges_m[beam];
      if (std::isinf(range_m)) continue;
      const auto rounded_m = static_cast<float>(rounded_range_m(range_m, step_m_));
      ranges_m[beam] = rounded_m;
      const double moved_m = std::abs(static_cast<double>(rounded_m) - range_m);
      if (moved_m == 0) continue;
      float& bound_m = bounds_m[beam];
      bound_m = std::nextafter(static_cast<float>(bound_m + moved_m), std::numeric_limits<float>::infinity());
    }
  }

 private:
  double step_m_;
};

const ScanEffectRegistration kRangeResolutionRegistration({
    .type = {.name = "range_resolution",
             .summary = "Ranges in steps.",
             .notes = "Rounding happens after noise; the error bound grows by as much as the range moved.",
             .source = "attribute range_resolution above 0",
             .outputs = kShownInRanges,
             .reference = "the nearest multiple, halves up",
             .needs = kCastsBeams,
             .attributes = kRangeResolutionAttributes},
    .order = ScanOrder::rounding,
    .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
      const double step_m = context.attributes.number("range_resolution");
      if (step_m == 0) return nullptr;
      return std::make_unique<RangeResolution>(step_m);
    },
});

}  // namespace
}  // namespace simvis
