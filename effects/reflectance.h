// How much of a laser's light a surface gives back.
#pragma once

#include "engine/surface_point.h"

namespace simvis {

/// Of a matte surface, [0, 1]: the mean of its linear base colour.
inline double reflectance(const SurfacePoint& surface) {
  const glm::dvec4 color(surface.base_color);
  return (color.r + color.g + color.b) / 3;
}

}  // namespace simvis
