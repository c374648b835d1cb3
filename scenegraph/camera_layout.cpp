#include <simvis/camera_layout.h>

#include <cmath>

#include "engine/base/assert.h"

namespace simvis {

double CameraLayout::axis_cosine(std::uint32_t x, std::uint32_t y) const {
  if (!rays.empty()) return rays[std::size_t{y} * width_px + x].z;
  const double tx = (x + 0.5 - pinhole.cx_px) / pinhole.fx_px, ty = (y + 0.5 - pinhole.cy_px) / pinhole.fy_px;
  return 1 / std::sqrt(1 + tx * tx + ty * ty);
}

std::optional<glm::dvec2> CameraLayout::pixel(const glm::dvec3& point) const {
  if (!rays.empty()) {
    SIMVIS_ASSERT(pixel_of != nullptr);
    return pixel_of(point);
  }
  if (point.z <= 0) return std::nullopt;
  return glm::dvec2(pinhole.cx_px + pinhole.fx_px * point.x / point.z,
                    pinhole.cy_px + pinhole.fy_px * point.y / point.z);
}

}  // namespace simvis
