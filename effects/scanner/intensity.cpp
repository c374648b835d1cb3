// The effect `intensity`: adds a channel with the light that returned from each echo.
//
// Channel  "intensity", in 1/m^2: share x reflectance x cosine / range^2 of the reported echo (see Echo). A white matte
//          wall at 1 m, perpendicular to the beam, has the value 1. A real scanner reports this value times a constant
//          of the device, often compressed or multiplied by range^2; both can be computed from the two columns.
// Special  NaN, an empty cell, where there is no range: 0 and inf.
// Reference  The lidar equation of an extended Lambertian target: A. V. Jelalian, Laser Radar Systems (Artech House
//            1992), ch. 1. The medium and the width of the beam are modelled by other effects.
#include <cmath>
#include <limits>

#include <simvis/scan_effect.h>
#include "engine/base/assert.h"

namespace simvis {
namespace {

constexpr AttributeSpec kIntensityAttributes[] = {
    {.name = "intensity",
     .kind = AttributeKind::choice,
     .default_value = "off",
     .text = "on: a column intensity in 1/m^2, reflectance x cosine / range^2",
     .choices = "off on"},
};

const TableColumn kIntensityColumns[] = {{.name = "intensity",
                                          .format = "%.9g",
                                          .unit = "1/m2",
                                          .meaning = "light that came back: reflectance x cosine / range^2",
                                          .nothing = std::numeric_limits<double>::quiet_NaN()}};

class Intensity : public ScanEffect {
 public:
  bool traces() const override { return true; }

  void finish(const ScanContext&, std::span<const Echo> detected, Scan& scan) const override {
    SIMVIS_ASSERT(detected.size() == scan.range_m.size());
    std::vector<double> values;
    values.reserve(detected.size());
    for (std::size_t beam = 0; beam < detected.size(); ++beam) {
      const bool measured = scan.range_m[beam] > 0 && std::isfinite(scan.range_m[beam]);
      values.push_back(measured ? detected[beam].power : std::numeric_limits<double>::quiet_NaN());
    }
    scan.add_channel(kIntensityColumns[0], std::move(values));
  }
};

// Runs after all effects that may lose a beam.
const ScanEffectRegistration kIntensityRegistration({
    .type = {.name = "intensity",
             .summary = "Adds a column with the light that came back from each echo.",
             .notes = "A white matte wall at a distance of 1 m, perpendicular to the beam, has the intensity 1. The "
                      "cell is empty without a range. Follows beams. Reflectance is that of the material element, or "
                      "the mean of the linear base colour.",
             .source = "attribute intensity=\"on\"",
             .outputs = kShownInRanges,
             .reference = "the lidar equation of an extended Lambertian target: Jelalian, Laser Radar Systems (1992)",
             .needs = kCastsBeams,
             .attributes = kIntensityAttributes},
    .order = ScanOrder::rounding,
    .create = [](const ScanEffectContext& context) -> std::unique_ptr<ScanEffect> {
      if (context.attributes.choice("intensity") != "on") return nullptr;
      return std::make_unique<Intensity>();
    },
    .columns = kIntensityColumns,
});

}  // namespace
}  // namespace simvis
