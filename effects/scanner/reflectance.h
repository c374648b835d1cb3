// The reflectance of a surface for laser light.
#pragma once

#include <algorithm>

#include <simvis/surface_point.h>

namespace simvis {

/// Reflectance of a matte surface, [0, 1]: the value of the material, or the mean of the linear base colour at the
/// point if the material has no value. Silicon detectors see the near infrared, and a colour says little about that:
/// set the reflectance of the material where it matters.
inline double reflectance(const SurfacePoint& surface) {
  if (surface.material->reflectance) return *surface.material->reflectance;
  const glm::dvec4 color(surface.base_color);
  return std::min((color.r + color.g + color.b) / 3, 1.0);  // a scene may set a colour brighter than white
}

}  // namespace simvis
