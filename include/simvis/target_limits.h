// The limits of a device's render targets.
#pragma once

#include <cstdint>
#include <vector>

namespace simvis {

/// The limits of a device's render targets.
struct TargetLimits {
  std::uint32_t width_px = 0,       ///< largest width of a target
      height_px = 0;                ///< largest height of a target
  std::vector<std::uint32_t> msaa;  ///< supported numbers of colour samples per pixel, ascending: always 1, and those
                                    ///< of 2, 4 and 8 that the device has
};

}  // namespace simvis
