// The effect `retro_reflection`: sheeting and corner cubes send light back to its source at any angle of incidence.
//
// Law      Within 40 degrees of normal incidence the echo's power is share x retro_reflectance / range^2: the
//          material's gain replaces reflectance x cosine. At larger angles the surface is matte like any other. A gain
//          of 1 corresponds to a white matte wall at normal incidence; the gain of sheeting is pi R_A, with R_A the
//          coefficient of retroreflection in cd/(lx m^2).
// Entrance The limit of 40 degrees is the largest angle for which EN 12899-1 states R_A; the return of prisms falls off
//          fast beyond it.
// Reference  ASTM E808 (terms), EN 12899-1:2007 table 3 and 4 (R_A of classes RA1, RA2).
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include <simvis/scan_effect.h>

namespace simvis {
namespace {

const double kMinCosine = std::cos(glm::radians(40.0));

class RetroReflection : public ScanEffect {
 public:
  bool only_traced() const override { return true; }

  void meet(const ScanContext&, const BeamRay& ray, const SurfacePoint& surface, Echo& echo,
            std::vector<BeamRay>&) const override {
    const double gain = surface.material->retro_reflectance;
    if (gain == 0 || -glm::dot(surface.normal, ray.direction) < kMinCosine) return;
    echo.power = ray.share * gain / (echo.range_m * echo.range_m);
  }
};

bool has_reflectors(const DrawList& list) {
  return std::ranges::any_of(list.materials, [](const auto& material) { return material->retro_reflectance > 0; });
}

const ScanEffectRegistration kRetroReflectionRegistration({
    .type = {.name = "retro_reflection",
             .summary = "Retro-reflectors send laser light back to the scanner.",
             .notes =
                 "A material with retro_reflectance (see the element material) has that gain within 40 degrees of the "
                 "perpendicular. It counts in scans whose effects follow beams; it has no attributes of its own.",
             .source = "a material with retro_reflectance above 0",
             .outputs = kShownInRanges,
             .reference = "coefficient of retroreflection: ASTM E808, EN 12899-1",
             .needs = kCastsBeams},
    .order = ScanOrder::path,
    .create = [](const ScanEffectContext&) -> std::unique_ptr<ScanEffect> {
      return std::make_unique<RetroReflection>();
    },
    .called_for = has_reflectors,
});

}  // namespace
}  // namespace simvis
