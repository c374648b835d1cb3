// The light of one lamp at a point, by the laws of KHR_lights_punctual.
#pragma once

#include <glm/glm.hpp>

#include <simvis/draw_list.h>
#include "engine/draw/luminance.h"

namespace simvis {

/// What reaches a plane from a light with nothing in between, and the way to the light. World frame.
struct DirectLight {
  glm::dvec3 irradiance{0};   ///< linear RGB
  double illuminance_lx = 0;  ///< its luminance
  glm::dvec3 toward{0};       ///< unit vector
  double distance_m = 0;      ///< +infinity of a directional light
};

/// At a point of a plane with the normal `normal` (unit length), of a light whose frame is `world_from_light`.
DirectLight direct_light(const Light& light, const glm::dmat4& world_from_light, const glm::dvec3& point_m,
                         const glm::dvec3& normal);

}  // namespace simvis
