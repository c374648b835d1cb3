// The effect `rolling_shutter`: the camera exposes one row after the other while it moves.
//
//   <sensor type="camera" ... row_time="3e-5" rows_per_pose="8"/>
//
// The last row is exposed at the frame's time, the first row (height - 1) row times earlier. Each row is rendered from
// the camera's pose at its own time, on its path from the previous measurement to this one: see <simvis/motion_path.h>.
// At its first measurement the camera is at rest. Other objects move on such paths too, so that what is fixed to the
// camera stands still in its pictures. Lights and shadows, and objects that are
// new or change their scale, stay as at the frame's time.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/camera_effect.h>

namespace simvis {

class RollingShutter : public CameraEffect {
 public:
  RollingShutter(double row_time_s, std::uint32_t rows_per_pose)
      : row_time_s_(row_time_s), rows_per_pose_(rows_per_pose) {}

  void configure_rays(CameraLayout& layout) const override;

 private:
  double row_time_s_;
  std::uint32_t rows_per_pose_;
};

}  // namespace simvis
