// Luminance of linear RGB.
#pragma once

#include <glm/glm.hpp>

namespace simvis {

/// ITU-R BT.709.
inline double luminance(const glm::dvec3& rgb) { return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z; }

}  // namespace simvis
