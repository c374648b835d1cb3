// What the electronics of a camera make of light: whole electrons, noise, and whole numbers.
//
//   <sensor type="camera" ... full_well_e="10000" read_noise_e="3" gain="2" adc_bits="10"/>
//
// Of each channel, as the EMVA Standard 1288 (release 4.0, section 2) has a linear camera:
//   light       an image of 1 sets `full_well_e` electrons free in the mean
//   shot noise  how many it really is follows Poisson's distribution, see poisson.h; a pixel holds no more than
//               `full_well_e`
//   read noise  Gaussian, of `read_noise_e` electrons, whatever the light
//   gain        the image is gain * electrons / full_well_e
//   converter   with `adc_bits`: cut to [0, 1] and rounded to one of 2^adc_bits levels. Without, nothing is cut: dark
//               pixels may be below 0, so that the mean stays right
// So a mean of mu electrons has the variance (gain / full_well_e)^2 (mu + read_noise_e^2), and 1 / 12 of a level's
// square more from rounding.
#pragma once

#include <cstdint>

#include <simvis/camera_effect.h>

namespace simvis {

struct PixelElectronics {
  double full_well_e = 10000;  ///< above 0
  double read_noise_e = 0, gain = 1;
  std::uint32_t adc_bits = 0;  ///< 0: no converter
};

class SensorNoise : public CameraEffect {
 public:
  SensorNoise(const PixelElectronics& electronics, const SensorRandom& random)
      : electronics_(electronics), random_(random) {}

  void post_process(const FrameTime& time, const CameraLayout&, Image& color) const override;

 private:
  double measured(double light, std::uint64_t frame, std::uint32_t pixel, std::uint32_t channel) const;

  PixelElectronics electronics_;
  SensorRandom random_;
};

}  // namespace simvis
