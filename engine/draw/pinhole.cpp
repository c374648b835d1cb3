#include <cmath>

#include <simvis/frame_plan.h>

namespace simvis {

Pinhole centred_pinhole(std::uint32_t width_px, std::uint32_t height_px, double hfov_rad) {
  const double focal_px = width_px / (2 * std::tan(hfov_rad / 2));
  return {focal_px, focal_px, width_px / 2.0, height_px / 2.0};
}

}  // namespace simvis
