// The plan of a frame with one picture.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/frame_plan.h>
#include <simvis/pose.h>

namespace simvis::bench {

/// A picture in colour from a sensor that stands at `world_from_sensor`.
inline FramePlan picture_plan(const glm::dmat4& world_from_sensor, double focal_px, std::uint32_t width_px,
                              std::uint32_t height_px) {
  View view;
  view.name = "picture";
  view.pinhole = {focal_px, focal_px, width_px / 2.0, height_px / 2.0};
  view.view_from_world = rigid_inverse(world_from_sensor * sensor_from_view());
  view.width_px = width_px;
  view.height_px = height_px;
  Pass pass;
  pass.width_px = width_px;
  pass.height_px = height_px;
  pass.color = true;
  pass.views = {view};
  return {{pass}};
}

}  // namespace simvis::bench
