// The effect `rolling_shutter`: the camera exposes one row after the other while it moves.
//
//   <sensor type="camera" ... row_time="3e-5" rows_per_pose="8"/>
//
// The last row is exposed at the frame's time, the first row (height - 1) row times earlier. Each row is rendered from
// the camera's pose at its own time, interpolated between the previous measurement and this one: see pose_between(). At
// its first measurement the camera is at rest. Other things move too: each row sees an item where the screw motion from
// its pose at the previous measurement to that at the frame's time has it at the row's time. Lights and shadows, and
// things that are new or change their scale, stay as at the frame's time.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/camera_effect.h>

namespace simvis {

/// Interpolates between two rigid poses, from `first` (share 0) to `last` (share 1). The position moves at constant
/// velocity along a line, and the rotation turns at a constant rate about one fixed axis. Shares outside [0, 1]
/// extrapolate in the same way.
glm::dmat4 pose_between(const glm::dmat4& first, const glm::dmat4& last, double share);

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
