#include "effects/camera/auto_exposure.h"

#include <algorithm>
#include <cmath>

namespace simvis {

namespace {

std::unique_ptr<CameraEffect> create_auto_exposure(const CameraEffectContext& context) {
  const ExposureControl control = rows_of<ExposureControl>().read(context.attributes);
  return control.target == 0 ? nullptr : std::make_unique<AutoExposure>(control);
}

const CameraEffectRegistration kAutoExposureRegistration(
    {.type = {.name = "auto_exposure",
              .summary = "An exposure that follows the light: the image is scaled by what the images before it showed.",
              .notes = "It acts after vignetting and before exposure, which may set a compensation. The first image is "
                       "taken with the factor 1.",
              .source = "attribute auto_exposure above 0",
              .outputs = kShownInColor,
              .reference = "the logarithm of the exposure approaches its end exponentially in a scene that stays",
              .needs = kHasImageSensor,
              .attributes = rows_of<ExposureControl>().table()},
     .order = CameraOrder::exposure,
     .create = create_auto_exposure});

// Mean of what an image shows with this exposure; white is 1 and saturates.
double metered_mean(const Image& color, double exposure) {
  double sum = 0;
  const std::vector<float>& pixels = color.pixels.numbers();
  for (std::size_t i = 0; i < pixels.size(); i += color.channels) {
    const glm::dvec3 rgb(pixels[i], pixels[i + 1], pixels[i + 2]);
    sum += std::clamp(exposure * glm::dot(rgb, glm::dvec3(0.2126, 0.7152, 0.0722)), 0.0, 1.0);
  }
  return sum * color.channels / static_cast<double>(pixels.size());
}

}  // namespace

AttributeRows<ExposureControl> ExposureControl::rows() {
  using Desc = ExposureControl;
  return {row(&Desc::target, "auto_exposure", "", {.min = 0, .max = 1},
              "mean luminance that the exposure is set for, such as 0.18; 0: the exposure is fixed"),
          row(&Desc::time_constant_s, "auto_exposure_time", "s", {.min = 0, .max = 1000},
              "time constant in which the exposure follows the light; 0: with the next image"),
          row(&Desc::least, "auto_exposure_min", "", {.min = 0, .max = 1, .open_min = true},
              "smallest factor of the image"),
          row(&Desc::most, "auto_exposure_max", "", {.min = 1, .max = 1e6}, "largest factor of the image")};
}

double ExposureControl::next(double exposure, double mean, double later_s) const {
  const double share = time_constant_s == 0 ? 1 : -std::expm1(-later_s / time_constant_s);
  if (mean <= 0) return most;
  return std::clamp(exposure * std::pow(target / mean, share), least, most);
}

void AutoExposure::post_process(const FrameTime& time, const CameraLayout&, Image& color) const {
  if (last_.time_ns >= 0 && time.time_ns > last_.time_ns) before_ = last_;
  double exposure = std::clamp(1.0, control_.least, control_.most);
  if (before_.time_ns >= 0) {
    const double later_s = static_cast<double>(time.time_ns - before_.time_ns) / 1e9;
    exposure = control_.next(before_.exposure, before_.mean, later_s);
  }
  last_ = {.time_ns = time.time_ns, .exposure = exposure, .mean = metered_mean(color, exposure)};
  std::vector<float>& pixels = color.pixels.edit();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (i % color.channels < 3) pixels[i] = static_cast<float>(exposure * static_cast<double>(pixels[i]));
  }
}

}  // namespace simvis
