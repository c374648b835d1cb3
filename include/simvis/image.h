// Images that cameras produce.
#pragma once

#include <cstdint>
#include <vector>

namespace simvis {

/// An image in host memory.
///
/// Shape    rows from the top; pixels[(y * width + x) * channels + c].
/// Units    colour: 4 channels, linear RGB radiance and alpha (always 1). Depth: 1 channel, depth along Z (the optical
///          axis) in metres, not range along the ray; +infinity where nothing is hit.
struct Image {
  std::uint32_t width = 0,    ///< in pixels
      height = 0,             ///< in pixels
      channels = 0;           ///< numbers per pixel
  std::vector<float> pixels;  ///< width * height * channels numbers
};

}  // namespace simvis
