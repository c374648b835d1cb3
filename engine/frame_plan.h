// Which views are rendered this frame, into which targets, and why. Plain data between the sensors and the renderer.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace simvis {

/// A pinhole camera in pixels: a point (x, y, z) of the view frame is seen at pixel
/// (cx + fx x / z, cy + fy y / z), where pixel (0, 0) has its centre at (0.5, 0.5).
struct Pinhole {
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;

  bool operator==(const Pinhole&) const = default;
};

/// One virtual camera drawn into a rectangle of its pass.
///
/// Frames   view frame: x right, y down, z forward (optical frame). `view_from_world` is rigid.
/// Depth    reversed, infinite far plane: d = near_m / z, 0 where nothing is hit.
struct View {
  std::string name;    ///< for --explain, debug labels and messages
  std::string reason;  ///< why it is rendered
  Pinhole pinhole;
  double near_m = 0.05;
  glm::dmat4 view_from_world{1.0};
  std::uint32_t x_px = 0, y_px = 0, width_px = 0, height_px = 0;  ///< rectangle in the pass's targets
  bool sees_back_faces = false;  ///< of single-sided materials too: a laser meets matter from either side
  bool sees_lines_and_points = true;
};

/// Views that share one set of targets and one render pass.
struct Pass {
  std::string name;
  std::uint32_t width_px = 0, height_px = 0;
  bool color = false;       ///< lit colour is wanted; false: no colour target exists and no light is evaluated
  bool depth = false;       ///< depth is read back
  std::vector<View> views;  ///< rectangles do not overlap
};

/// Rays that a sensor casts after the passes are there.
struct RayCast {
  std::string name;
  std::string reason;
  std::uint64_t most_rays = 0;  ///< how many it casts at the most: which, it may learn from the passes
  std::string engine{};         ///< who casts them: see RayCaster. Known to who runs the plan
};

struct FramePlan {
  std::vector<Pass> passes;
  std::vector<RayCast> casts{};
};

}  // namespace simvis
