// The effect `motion_blur`: colour is exposed for a time in which the camera and the world move.
//
//   <sensor type="camera" ... exposure_time="0.01" motion_samples="16"/>
//
// The exposure of a row ends at the row's time, which is that of the frame without a rolling shutter. The picture is
// the mean, in linear light, of `motion_samples` pictures at the middles of equal parts of the exposure. In each of
// them the camera and the objects stand where rolling_shutter.h says, between the last measurement and this one; a
// camera at its first measurement, and one that sees nothing move, take one picture. Depth and truth are those of the
// row's time.
//
// Error    An edge that crosses n pixels during the exposure is drawn in `motion_samples` steps: a pixel's share of it
//          errs by at most one step, 1 / motion_samples, and the mean of many pixels by less.
#pragma once

#include <cstdint>

#include <simvis/camera_effect.h>

namespace simvis {

class MotionBlur : public CameraEffect {
 public:
  /// `at`: where the number of samples was written, for messages.
  MotionBlur(double exposure_s, std::uint32_t samples, const Location& at = {})
      : exposure_s_(exposure_s), samples_(samples), at_(at) {}

  void configure_rays(CameraLayout& layout) const override;

 private:
  double exposure_s_;
  std::uint32_t samples_;
  Location at_;
};

}  // namespace simvis
