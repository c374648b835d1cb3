// The light of one lamp at a point, by the laws of KHR_lights_punctual.
#pragma once

#include <glm/glm.hpp>

#include <simvis/draw_list.h>

namespace simvis {

/// What a plane across the way to a light gets with nothing in between. In the frame of the point.
struct DirectLight {
  glm::dvec3 irradiance{0};  ///< linear RGB; that of another plane is this times the cosine of its normal to `toward`
  glm::dvec3 toward{0};      ///< unit vector
  double distance_m = 0;     ///< +infinity of a directional light
};

/// At a point, of a light whose frame is `frame`.
DirectLight direct_light(const Light& light, const glm::dmat4& frame, const glm::dvec3& point_m);

}  // namespace simvis
