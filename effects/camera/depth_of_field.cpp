#include "effects/camera/depth_of_field.h"

namespace simvis {

namespace {

std::unique_ptr<CameraEffect> create_depth_of_field(const CameraEffectContext& context) {
  const ThinLens lens = rows_of<ThinLens>().read(context.attributes);
  return lens.aperture_m == 0 ? nullptr : std::make_unique<DepthOfField>(lens);
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
              .attributes = rows_of<ThinLens>().table()},
     .order = CameraOrder::aperture,
     .create = create_depth_of_field});

}  // namespace

AttributeRows<ThinLens> ThinLens::rows() {
  return {row(&ThinLens::aperture_m, "aperture", "m", {.min = 0, .max = 1},
              "diameter of the lens; 0: a pinhole, sharp everywhere"),
          row(&ThinLens::focus_m, "focus_distance", "m", {.min = 0, .max = 1e9, .open_min = true},
              "with aperture: depth at which the picture is sharp"),
          row(&ThinLens::samples, "lens_samples", "", {.min = 4, .max = 256},
              "with aperture: points of the lens from which pictures are taken"),
          checked<ThinLens>([](ThinLens& lens, const AttributeValues& attributes) {
            lens.at = attributes.where("aperture");
            lens.samples_at = attributes.where("lens_samples");
          })};
}

void DepthOfField::configure_rays(CameraLayout& layout) const {
  layout.exposure.aperture_m = lens_.aperture_m / 2;
  layout.exposure.aperture_at = lens_.at;
  layout.exposure.focus_m = lens_.focus_m;
  layout.exposure.take(lens_.samples, lens_.samples_at);
}

}  // namespace simvis
