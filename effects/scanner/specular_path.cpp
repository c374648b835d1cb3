// The effect `specular_path`: mirrors reflect beams and glass transmits them, up to `path_depth` times per beam.
//
// Shares   engine/light/surface_shares.h. Light returns along the same path, so the share of the beam that a continued
//          ray carries is the square of the one-way share.
// Mirror   The angle of reflection equals the angle of incidence. The range is the length of the whole unfolded path.
// Pane     Rays continue in the same direction, from the same origin.
// Depth    A beam ends after `path_depth` mirrors and panes; what the last of them sends on is lost.
//
// Not modelled: the glint of a mirror that the beam hits at a right angle, which returns directly to the receiver.
// Where a reflected ray begins: see effects/scanner/onward_ray.h.
#include <algorithm>
#include <cmath>

#include <simvis/scan_effect.h>
#include "effects/scanner/onward_ray.h"
#include "effects/scanner/reflectance.h"
#include "engine/light/surface_shares.h"

namespace simvis {
namespace {

constexpr double kUnit = 0x1p-53;

constexpr AttributeSpec kSpecularPathAttributes[] = {
    {.name = "path_depth",
     .kind = AttributeKind::integer,
     .default_value = "0",
     .text = "number of times a beam continues; 0: mirrors and glass are surfaces like others",
     .min = 0,
     .max = 16},
};

class SpecularPath : public ScanEffect {
 public:
  explicit SpecularPath(std::uint32_t depth) : depth_(depth) {}

  bool traces() const override { return true; }

  void meet(const ScanContext&, const BeamRay& ray, const SurfacePoint& surface, Echo& echo,
            std::vector<BeamRay>& onward) const override {
    const double cosine = -glm::dot(surface.normal, ray.direction);
    if (!(cosine > 0)) return;
    const Material& material = *surface.material;
    if (material.mirror == 0 && material.transmission == 0) return;
    const double error_m = echo.error_bound_m;
    const SurfaceShares shares = surface_shares(material, reflectance(surface), cosine);
    echo.power *= shares.matte;
    if (shares.matte == 0) echo.range_m = std::numeric_limits<double>::infinity();
    if (ray.turns >= depth_) return;
    if (shares.reflected > 0) onward.push_back(reflected(ray, surface, cosine, shares.reflected, error_m));
    if (shares.passed > 0) onward.push_back(passed(ray, surface, shares.passed));
  }

 private:
  static BeamRay reflected(const BeamRay& ray, const SurfacePoint& surface, double cosine, double share,
                           double error_m) {
    BeamRay onward = onward_ray(ray, surface, glm::normalize(ray.direction + 2 * cosine * surface.normal), cosine);
    onward.share = ray.share * share * share;
    onward.error_m = error_m;
    onward.origin_error_m += error_m;
    onward.error_rad = ray.error_rad + 2 * surface.normal_error_rad + 8 * kUnit;
    return onward;
  }

  // Two triangles of a pane that meet under the ray count as one: their ranges are each off by at most the bound.
  static BeamRay passed(const BeamRay& ray, const SurfacePoint& surface, double share) {
    BeamRay onward = ray;
    onward.share = ray.share * share * share;
    onward.t_min_m = surface.range_m + 2 * surface.error_bound_m;
    ++onward.turns;
    return onward;
  }

  std::uint32_t depth_;
};

std::unique_ptr<ScanEffect> create_specular_path(const ScanEffectContext& context) {
  const std::int64_t depth = context.attributes.integer("path_depth");
  return depth == 0 ? nullptr : std::make_unique<SpecularPath>(static_cast<std::uint32_t>(depth));
}

bool called_for(const DrawList& list) {
  return std::ranges::any_of(list.items, [&](const DrawItem& item) {
    const Material& material = *list.materials[item.material];
    return item.visible && (material.mirror > 0 || material.transmission > 0);
  });
}

const ScanEffectRegistration kSpecularPathRegistration({
    .type = {.name = "specular_path",
             .summary = "Beams continue from mirrors and through panes of glass.",
             .notes = "Mirrors and glass are materials with mirror or transmission (see the element material), or with "
                      "glTF's KHR_materials_transmission. The range is the length of the whole path.",
             .source = "attribute path_depth above 0, and a material with mirror or transmission above 0",
             .outputs = kShownInRanges,
             .knob = "path_depth",
             .reference = "the law of reflection, Fresnel's equations",
             .needs = kCastsBeams,
             .attributes = kSpecularPathAttributes},
    .order = ScanOrder::path,
    .create = create_specular_path,
    .called_for = called_for,
});

}  // namespace
}  // namespace simvis
