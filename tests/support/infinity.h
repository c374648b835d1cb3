// What a beam without a hit measures, and a pixel without a surface.
#pragma once

#include <limits>

namespace simvis {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();  // exact as a double, too

}  // namespace simvis
