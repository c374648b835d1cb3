// Pictures that cameras take.
#pragma once

#include <cstdint>
#include <vector>

namespace simvis {

/// A picture in host memory.
///
/// Shape    rows from the top; pixels[(y * width + x) * channels + c].
/// Units    colour: 4 channels, linear RGB radiance and alpha (always 1). Depth: 1 channel, metres along the optical
///          axis (depth along Z, not range along the ray); +infinity where nothing is hit.
struct Image {
  std::uint32_t width = 0, height = 0, channels = 0;
  std::vector<float> pixels;
};

}  // namespace simvis
