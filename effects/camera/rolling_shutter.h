// A shutter that exposes one row after the other while the camera moves.
//
//   <sensor type="camera" ... row_time="3e-5" rows_per_pose="8"/>
//
// The last row is taken at the frame's time, the first one (height - 1) row times before. Each is seen from where the
// camera was then, between its last measurement and this one: see pose_between(). At its first measurement it is at
// rest. What it sees stands where it is at the frame's time.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/camera_effect.h>

namespace simvis {

/// Both rigid. On the way from `first` (share 0) to `last` (share 1) the position moves evenly along a line, and the
/// turn from one to the other grows evenly about its one axis; shares beyond go on in the same way.
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
