#include "effects/camera/sensor_noise.h"

#include <algorithm>
#include <cmath>

#include "engine/base/poisson.h"

namespace simvis {

namespace {

constexpr AttributeSpec kSensorNoiseAttributes[] = {
    {.name = "full_well_e",
     .default_value = "0",
     .unit = "electrons",
     .text = "what a pixel holds, and an image of 1 sets free, in each channel; 0: no noise, no gain, no converter",
     .min = 0,
     .max = 1e9},
    {.name = "read_noise_e",
     .default_value = "0",
     .unit = "electrons",
     .text = "standard deviation of what reading a pixel adds",
     .min = 0,
     .max = 1e9},
    {.name = "gain",
     .default_value = "1",
     .text = "of the amplifier, after the noise: 1 makes a full pixel an image of 1",
     .min = 0,
     .max = 1e6,
     .open_min = true},
    {.name = "adc_bits",
     .kind = AttributeKind::integer,
     .unit = "bit",
     .text = "of the converter: levels from 0 to 1; if not given, none rounds or cuts",
     .min = 1,
     .max = 24},
};

std::unique_ptr<CameraEffect> create_sensor_noise(const CameraEffectContext& context) {
  const AttributeValues& a = context.attributes;
  const PixelElectronics electronics{
      .full_well_e = a.number("full_well_e"),
      .read_noise_e = a.number("read_noise_e"),
      .gain = a.number("gain"),
      .adc_bits = a.is_set("adc_bits") ? static_cast<std::uint32_t>(a.integer("adc_bits")) : 0};
  if (electronics.full_well_e == 0) return nullptr;
  return std::make_unique<SensorNoise>(electronics, context.random("sensor_noise"));
}

const CameraEffectRegistration kSensorNoiseRegistration(
    {.type = {.name = "sensor_noise",
              .summary = "Shot and read noise in electrons, gain and the converter's levels.",
              .source = "attribute full_well_e above 0",
              .outputs = kShownInColor,
              .reference = "EMVA Standard 1288, release 4.0, section 2",
              .sensors = "camera stereo_camera",
              .attributes = kSensorNoiseAttributes,
              .example = {.attributes = R"(full_well_e="10000" read_noise_e="4" adc_bits="10")",
                          .off_attributes = R"(full_well_e="0" read_noise_e="4" adc_bits="10")"}},
     .order = CameraOrder::electronics,
     .create = create_sensor_noise});

}  // namespace

double SensorNoise::measured(double light, std::uint64_t frame, std::uint32_t pixel, std::uint32_t channel) const {
  const PixelElectronics& e = electronics_;
  // What is far beyond the full well fills it whatever the noise.
  const double mean_e = std::clamp(light, 0.0, 1e3) * e.full_well_e;
  double electrons = std::min(poisson(random_, mean_e, frame, pixel, 2 * channel), e.full_well_e);
  if (e.read_noise_e > 0) electrons += e.read_noise_e * random_.gaussian(frame, pixel, 2 * channel + 1);
  const double value = e.gain * electrons / e.full_well_e;
  if (e.adc_bits == 0) return value;
  const double levels = std::exp2(e.adc_bits) - 1;
  return std::round(std::clamp(value, 0.0, 1.0) * levels) / levels;
}

void SensorNoise::post_process(const FrameTime& time, const CameraLayout&, Image& color) const {
  const std::uint32_t pixels = color.width * color.height;
  for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
    for (std::uint32_t channel = 0; channel < 3; ++channel) {
      float& value = color.pixels[std::size_t{pixel} * color.channels + channel];
      value = static_cast<float>(measured(value, time.index, pixel, channel));
    }
  }
}

}  // namespace simvis
