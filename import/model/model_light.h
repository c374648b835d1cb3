// A light of a file of a robot or a world, whatever the format.
#pragma once

#include <glm/glm.hpp>
#include <string>

namespace simvis {

struct ModelLight {
  enum class Kind { directional, point, spot } kind = Kind::directional;
  glm::dvec3 color{1};                  ///< sRGB-encoded
  double intensity = 0;                 ///< lux of a directional light, candela of the others
  glm::dvec3 position_m{0};             ///< in the frame of the insertion point, of point and spot
  glm::dvec3 direction{0, 0, -1};       ///< in which the light travels, of unit length, of directional and spot
  double range_m = 0;                   ///< 0: without an end
  double inner_rad = 0, outer_rad = 0;  ///< of spot, from the axis
  bool has_shadows = false;
};

/// The element `light`. Intensities above what it allows are the largest one.
std::string light_command(const ModelLight& light, const std::string& name, const std::string& insert_at);

}  // namespace simvis
