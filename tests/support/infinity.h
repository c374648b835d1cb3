// The range of a beam without a hit, and the depth of a pixel without a surface.
#pragma once

#include <limits>

namespace simvis {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();  // exact as a double, too

}  // namespace simvis
