// What a device can render to.
#pragma once

#include <cstdint>
#include <vector>

namespace simvis {

/// What a device can render to.
struct TargetLimits {
  std::uint32_t width_px = 0, height_px = 0;  ///< the largest target
  std::vector<std::uint32_t> msaa;  ///< numbers of samples per pixel of colour that the device supports, ascending:
                                    ///< always 1, and those of 2, 4 and 8 that it has
};

}  // namespace simvis
