// The effect `lens_distortion`: the distortion of a camera's lens; see lens.h for the models.
//
//   <sensor type="camera" ... distortion="kannala_brandt" fx="290" k1="-0.02" lens_oversampling="2"/>
#pragma once

#include <optional>

#include <simvis/camera_effect.h>
#include "effects/camera/lens.h"

namespace simvis {

class LensDistortion : public CameraEffect {
 public:
  explicit LensDistortion(const AttributeValues& attributes);

  /// Sets the rays of all pixels and the intrinsics. Throws InputError with the location if the model has no ray for a
  /// pixel of the image.
  void configure_rays(CameraLayout& layout) const override;

 private:
  LensModel model_;  // the pinhole parameters that are set are in given_
  struct {
    std::optional<double> fx_px, fy_px, cx_px, cy_px;
  } given_;
  double oversampling_;
  Location oversampling_at_, distortion_at_;
};

}  // namespace simvis
