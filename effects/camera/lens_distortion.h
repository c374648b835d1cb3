// The effect `lens_distortion`: the distortion of a camera's lens; see lens.h for the models.
//
//   <sensor type="camera" ... distortion="kannala_brandt" fx="290" k1="-0.02" lens_oversampling="2"/>
#pragma once

#include <memory>
#include <vector>

#include <simvis/camera_effect.h>
#include "effects/camera/lens.h"

namespace simvis {

class LensDistortion : public CameraEffect {
 public:
  /// Throws InputError at a coefficient that is wrong, or that belongs to another model.
  LensDistortion(const LensType& type, const AttributeValues& attributes);

  /// Sets the rays of all pixels and the distortion of the calibration. Throws InputError with the location if the
  /// model has no ray for a pixel of the image.
  void configure_rays(CameraLayout& layout) const override;

 private:
  const LensType& type_;
  std::vector<double> coefficients_;
  std::shared_ptr<const LensModel> model_;
  double oversampling_;
  Location oversampling_at_, distortion_at_;
};

}  // namespace simvis
