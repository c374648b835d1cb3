// The effect `sensor_noise`: shot noise, read noise, gain and quantisation of a camera's electronics.
//
//   <sensor type="camera" ... full_well_e="10000" read_noise_e="3" gain="2" adc_bits="10"/>
//
// Each channel follows the linear camera model of the EMVA Standard 1288 (release 4.0, section 2):
//   light       an image value of 1 releases `full_well_e` electrons on average
//   shot noise  the actual number of electrons has a Poisson distribution, see poisson.h; a pixel holds no more than
//               `full_well_e`
//   read noise  Gaussian noise of `read_noise_e` electrons, independent of the light
//   gain        the image value is gain * electrons / full_well_e
//   converter   with `adc_bits` the value is clamped to [0, 1] and rounded to one of 2^adc_bits levels. Without
//               `adc_bits` it is not clamped: dark pixels may be below 0, so that the mean stays correct
// A mean of mu electrons therefore has the variance (gain / full_well_e)^2 (mu + read_noise_e^2). Rounding adds 1 / 12
// of the square of a level.
#pragma once

#include <cstdint>

#include <simvis/camera_effect.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

struct PixelElectronics {
  double full_well_e = 0;  ///< 0: no noise
  double read_noise_e = 0, gain = 1;
  std::uint32_t adc_bits = 0;  ///< 0: no converter

  static AttributeRows<PixelElectronics> rows();
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
