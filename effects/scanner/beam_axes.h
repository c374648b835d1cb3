// The axes of the beams of a scan, for effects on what lies along a beam beside surfaces.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/scan_effect.h>

namespace simvis {

/// The axis of a beam, in the frame of its rays.
struct BeamAxis {
  glm::dvec3 origin_m{0};
  glm::dvec3 direction{0};  ///< unit length; 0: the beam has no rays
};

/// By beam: from where its rays leave, in their mean direction, each with its share.
inline std::vector<BeamAxis> beam_axes(std::span<const BeamRay> rays) {
  std::vector<BeamAxis> axes;
  for (const BeamRay& ray : rays) {
    if (ray.beam >= axes.size()) axes.resize(ray.beam + 1);
    axes[ray.beam].origin_m = ray.origin_m;
    axes[ray.beam].direction += ray.share * ray.direction;
  }
  for (BeamAxis& axis : axes) {
    if (axis.direction != glm::dvec3(0)) axis.direction = glm::normalize(axis.direction);
  }
  return axes;
}

}  // namespace simvis
