#include "effects/scanner/reflectivity.h"

#include <limits>

#include <simvis/scan_effect.h>
#include "engine/base/assert.h"

namespace simvis {
namespace {

constexpr AttributeSpec kReflectivityAttributes[] = {
    {.name = "reflectivity",
     .kind = AttributeKind::choice,
     .default_value = "off",
     .text = "on: a column reflectivity from 0 to 255, as devices give it: a white matte wall has 100",
     .choices = "off on"},
};

const TableColumn kReflectivityColumns[] = {{.name = "reflectivity",
                                             .format = "%.0f",
                                             .meaning = "100: a white matte surface at a right angle; at most 255",
                                             .nothing = std::numeric_limits<double>::quiet_NaN()}};

class Reflectivity : public ScanEffect {
 public:
  bool traces() const override { return true; }

  void finish(const ScanContext&, std::span<const Echo> detected, Scan& scan) const override {
    SIMVIS_ASSERT(detected.size() == scan.range_m.size());
    std::vector<double> values;
    values.reserve(detected.size());
    for (std::size_t beam = 0; beam < detected.size(); ++beam) {
      const double range_m = scan.range_m[beam];
      const bool measured = range_m > 0 && std::isfinite(range_m);
      values.push_back(measured ? calibrated_reflectivity(detected[beam].power, detected[beam].range_m)
                                : std::numeric_limits<double>::quiet_NaN());
    }
    scan.add_channel(kReflectivityColumns[0], std::move(values));
  }
};

// Runs after all effects that may lose a beam.
const ScanEffectRegistration kReflectivityRegistration({
    .type = {.name = "reflectivity",
             .summary = "Adds a column with the reflectivity in the unit of devices, from 0 to 255.",
             .notes = "It is 100 times reflectance x cosine, whatever the range: 100 for a white matte wall at a right "
                      "angle, 101 to 255 for retro-reflectors. Weather and mirrors lower it, as in a real device. The "
                      "cell is empty without a range. Follows beams.",
             .source = "attribute reflectivity=\"on\"",
             .outputs = kShownInRanges,
             .reference = "calibrated reflectivity: VLP-16 User Manual, 63-9243, section 6.1",
             .needs = kCastsBeams,
             .attributes = kReflectivityAttributes},
    .order = ScanOrder::rounding,
    .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
      if (context.attributes.choice("reflectivity") != "on") return nullptr;
      return std::make_unique<Reflectivity>();
    },
    .columns = kReflectivityColumns,
});

}  // namespace
}  // namespace simvis
