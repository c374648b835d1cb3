#include "effects/camera/motion_blur.h"

namespace simvis {

namespace {

constexpr AttributeSpec kMotionBlurAttributes[] = {
    {.name = "exposure_time",
     .default_value = "0",
     .unit = "s",
     .text = "time for which colour is exposed, until the row's time; 0: an instant",
     .min = 0,
     .max = 10},
    {.name = "motion_samples",
     .kind = AttributeKind::integer,
     .default_value = "16",
     .text = "pictures within the exposure whose mean is taken; a camera that sees nothing move takes one",
     .min = 1,
     .max = 256},
};

std::unique_ptr<CameraEffect> create_motion_blur(const CameraEffectContext& context) {
  const double exposure_s = context.attributes.number("exposure_time");
  if (exposure_s == 0) return nullptr;
  return std::make_unique<MotionBlur>(exposure_s,
                                      static_cast<std::uint32_t>(context.attributes.integer("motion_samples")),
                                      context.attributes.where("motion_samples"));
}

const CameraEffectRegistration kMotionBlurRegistration(
    {.type =
         {.name = "motion_blur",
          .summary = "Colour that is exposed for a time while the camera and the world move.",
          .notes =
              "The exposure ends at the time of the frame, or of the row. The camera and all objects move along "
              "their joints between the last measurement and this one. Lights and shadows are those of the time of the "
              "frame. It does not change brightness: see exposure.",
          .source = "attribute exposure_time above 0",
          .outputs = kShownInColor,
          .knob = "motion_samples",
          .reference = "the share of the exposure that a pixel sees each surface, from the motion of its edges; "
                       "Haeberli and Akeley, The accumulation buffer, SIGGRAPH 1990",
          .needs = kHasPixelRays,
          .attributes = kMotionBlurAttributes},
     .order = CameraOrder::shutter,
     .create = create_motion_blur});

}  // namespace

void MotionBlur::configure_rays(CameraLayout& layout) const {
  layout.exposure.time_s = exposure_s_;
  layout.exposure.take(samples_, at_);
}

}  // namespace simvis
