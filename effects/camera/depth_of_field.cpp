#include "effects/camera/depth_of_field.h"

namespace simvis {

namespace {

constexpr AttributeSpec kDepthOfFieldAttributes[] = {
    {.name = "aperture",
     .default_value = "0",
     .unit = "m",
     .text = "diameter of the lens; 0: a pinhole, sharp everywhere",
     .min = 0,
     .max = 1},
    {.name = "focus_distance",
     .default_value = "1",
     .unit = "m",
     .text = "with aperture: depth at which the picture is sharp",
     .min = 0,
     .max = 1e9,
     .open_min = true},
    {.name = "lens_samples",
     .kind = AttributeKind::integer,
     .default_value = "64",
     .text = "with aperture: points of the lens from which pictures are taken",
     .min = 4,
     .max = 256},
};

std::unique_ptr<CameraEffect> create_depth_of_field(const CameraEffectContext& context) {
  const AttributeValues& a = context.attributes;
  if (a.number("aperture") == 0) return nullptr;
  return std::make_unique<DepthOfField>(ThinLens{.aperture_m = a.number("aperture"),
                                                 .focus_m = a.number("focus_distance"),
                                                 .samples = static_cast<std::uint32_t>(a.integer("lens_samples")),
                                                 .at = a.where("aperture"),
                                                 .samples_at = a.where("lens_samples")});
}

const CameraEffectRegistration kDepthOfFieldRegistration(
    {.type = {.name = "depth_of_field",
              .summary = "A lens with an opening: what is nearer or farther than its focus is blurred.",
              .notes = "A thin lens without aberrations. Depth and truth are those of the centre of the lens. A "
                       "fisheye that takes several views cannot have it.",
              .source = "attribute aperture above 0",
              .outputs = kShownInColor,
              .knob = "lens_samples",
              .reference = "circle of the diameter fx aperture |1 / Z - 1 / focus_distance|; Potmesil and Chakravarty, "
                           "A lens and aperture camera model, SIGGRAPH 1981",
              .needs = kHasPixelRays,
              .attributes = kDepthOfFieldAttributes},
     .order = CameraOrder::aperture,
     .create = create_depth_of_field});

}  // namespace

void DepthOfField::configure_rays(CameraLayout& layout) const {
  layout.exposure.aperture_m = lens_.aperture_m / 2;
  layout.exposure.aperture_at = lens_.at;
  layout.exposure.focus_m = lens_.focus_m;
  layout.exposure.take(lens_.samples, lens_.samples_at);
}

}  // namespace simvis
