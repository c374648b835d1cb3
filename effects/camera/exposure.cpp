#include "effects/camera/exposure.h"

namespace simvis {

namespace {

constexpr AttributeSpec kExposureAttributes[] = {
    {.name = "exposure",
     .default_value = "1",
     .text = "exposure time, relative to that at which a radiance of 1 gives an image of 1",
     .min = 0,
     .max = 1e6,
     .open_min = true},
};

std::unique_ptr<CameraEffect> create_exposure(const CameraEffectContext& context) {
  const double factor = context.attributes.number("exposure");
  return factor == 1 ? nullptr : std::make_unique<Exposure>(factor);
}

const CameraEffectRegistration kExposureRegistration(
    {.type = {.name = "exposure",
              .summary = "A longer or shorter exposure: the linear image is scaled.",
              .source = "attribute exposure other than 1",
              .outputs = kShownInColor,
              .reference = "light collected is irradiance times time: EMVA Standard 1288, release 4.0, section 2",
              .needs = kHasImageSensor,
              .attributes = kExposureAttributes},
     .order = CameraOrder::exposure,
     .create = create_exposure});

}  // namespace

void Exposure::post_process(const FrameTime&, const CameraLayout&, Image& color) const {
  std::vector<float>& pixels = color.pixels.edit();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    float& value = pixels[i];
    if (i % color.channels < 3) value = static_cast<float>(factor_ * static_cast<double>(value));
  }
}

}  // namespace simvis
