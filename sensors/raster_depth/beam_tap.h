// The position of a beam among the depth pixels of a virtual camera.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include <simvis/frame_plan.h>

namespace simvis {

/// One virtual camera of at most 90 degrees by 90 degrees, cropped to the pixels that its beams need.
struct ScanFace {
  glm::dmat3 face_from_sensor{1.0};  ///< rotation; the face's frame is x right, y down, z forward
  Pinhole pinhole;                   ///< fx = fy, or fy = kRowsPerPixel fx
  std::uint32_t width_px = 0, height_px = 0;
  std::uint32_t beams = 0;
  std::shared_ptr<const std::vector<std::uint32_t>> columns;  ///< ascending; columns of the beams' neighbourhoods
};

/// The position of a beam in the pixel grid of its face: between the centres of pixels (x, y) and (x + 1, y + 1).
struct BeamTap {
  std::uint32_t face = 0;
  std::uint32_t x = 0, y = 0;
  double fraction_x = 0, fraction_y = 0;  ///< [0, 1] of the way to the next centre
  double tangent_x = 0, tangent_y = 0;    ///< the beam meets the plane z = 1 of the face at (tangent_x, tangent_y, 1)
  double ray_per_depth = 1;               ///< range along the ray = ray_per_depth * depth along Z
};

/// Pixels kept around the outermost beams, so that each beam has its neighbourhood: 2 before its pixel and 3 after it.
inline constexpr int kPixelsBefore = 2, kPixelsAfter = 3;

}  // namespace simvis
