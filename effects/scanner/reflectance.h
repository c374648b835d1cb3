// How much of a laser's light a surface gives back.
#pragma once

#include <algorithm>

#include <simvis/surface_point.h>

namespace simvis {

/// Of a matte surface, [0, 1]: what its material says of lasers, or, where it says nothing, the mean of the linear base
/// colour there. Silicon detectors see the near infrared, of which a colour tells little: say it where it matters.
inline double reflectance(const SurfacePoint& surface) {
  if (surface.material->reflectance) return *surface.material->reflectance;
  const glm::dvec4 color(surface.base_color);
  return std::min((color.r + color.g + color.b) / 3, 1.0);  // an element may make a colour brighter than white
}

}  // namespace simvis
