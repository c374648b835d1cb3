// The effect `exposure`: scales the linear image of a camera.
//
//   <sensor type="camera" ... exposure="2"/>
#pragma once

#include <simvis/camera_effect.h>

namespace simvis {

class Exposure : public CameraEffect {
 public:
  explicit Exposure(double factor) : factor_(factor) {}

  void post_process(const FrameTime&, const CameraLayout&, Image& color) const override;

 private:
  double factor_;
};

}  // namespace simvis
