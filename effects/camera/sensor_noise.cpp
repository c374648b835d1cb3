#include "effects/camera/sensor_noise.h"

#include <algorithm>
#include <cmath>

#include "engine/base/poisson.h"

namespace simvis {

namespace {

std::unique_ptr<CameraEffect> create_sensor_noise(const CameraEffectContext& context) {
  const PixelElectronics electronics = rows_of<PixelElectronics>().read(context.attributes);
  if (electronics.full_well_e == 0) return nullptr;
  return std::make_unique<SensorNoise>(electronics, context.random("sensor_noise"));
}

const CameraEffectRegistration kSensorNoiseRegistration(
    {.type = {.name = "sensor_noise",
              .summary = "Shot noise and read noise in electrons, gain, and the levels of the converter.",
              .notes = "Follows vignetting and exposure, for each channel by itself. The two pictures of a stereo "
                       "camera have independent noise.",
              .source = "attribute full_well_e above 0",
              .outputs = kShownInColor,
              .reference = "EMVA Standard 1288, release 4.0, section 2",
              .needs = kHasImageSensor,
              .attributes = rows_of<PixelElectronics>().table()},
     .order = CameraOrder::electronics,
     .create = create_sensor_noise});

}  // namespace

AttributeRows<PixelElectronics> PixelElectronics::rows() {
  using Desc = PixelElectronics;
  return {row(&Desc::full_well_e, "full_well_e", "electrons", {.min = 0, .max = 1e9},
              "electrons that a pixel holds, at an image of 1; 0: the effect is off"),
          row(&Desc::read_noise_e, "read_noise_e", "electrons", {.min = 0, .max = 1e9},
              "standard deviation of the read noise"),
          row(&Desc::gain, "gain", "", {.min = 0, .max = 1e6, .open_min = true},
              "gain after the noise; with 1 a full pixel is an image of 1"),
          row(&Desc::adc_bits, "adc_bits", "bit", {.min = 1, .max = 24},
              "bits of the converter, which clamps to [0, 1] and rounds; default: no converter")
              .without_default()};
}

double SensorNoise::measured(double light, std::uint64_t frame, std::uint32_t pixel, std::uint32_t channel) const {
  const PixelElectronics& e = electronics_;
  // Light far beyond the full well fills it, whatever the noise is.
  const double mean_e = std::clamp(light, 0.0, 1e3) * e.full_well_e;
  double electrons = std::min(poisson(random_, mean_e, frame, pixel, 2 * channel), e.full_well_e);
  if (e.read_noise_e > 0) electrons += e.read_noise_e * random_.gaussian(frame, pixel, 2 * channel + 1);
  const double value = e.gain * electrons / e.full_well_e;
  if (e.adc_bits == 0) return value;
  const double levels = std::exp2(e.adc_bits) - 1;
  return std::round(std::clamp(value, 0.0, 1.0) * levels) / levels;
}

void SensorNoise::post_process(const FrameTime& time, const CameraLayout&, Image& color) const {
  std::vector<float>& values = color.pixels.edit();
  const std::uint32_t pixels = color.width * color.height;
  for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
    for (std::uint32_t channel = 0; channel < 3; ++channel) {
      float& value = values[std::size_t{pixel} * color.channels + channel];
      value = static_cast<float>(measured(value, random_key(time), pixel, channel));
    }
  }
}

}  // namespace simvis
