// A picture of the sky as a few distant lights.
//
// Method   The median cut of P. Debevec ("A Median Cut Algorithm for Light Probe Sampling", SIGGRAPH 2005 posters): a
//          region of the picture is cut across its longer side, so that both parts have the same light. The region with
//          the most light is cut next, so that a sun of one pixel does not use up the lights of the rest.
// Light    A region's light has all of the region's light, which conserves the picture's, and comes from the middle of
//          the region weighted by luminance.
// Error    With n regions the light of matte surfaces in all directions errs by less than 1.25 / n of its mean in the
//          root mean square: a region's radius goes with 1 / sqrt(n), and the error with the square of the radius.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include <simvis/sky_picture.h>

namespace simvis {

struct SkyRegion {
  glm::dvec3 irradiance{0};     ///< linear RGB, of a surface that faces the light
  glm::dvec3 towards{0, 0, 1};  ///< the direction of the light in the picture's frame, unit length
};

/// At most `most` regions, which together are all of the picture that is not black; fewer only if each of them is one
/// pixel. At least one.
std::vector<SkyRegion> cut_sky(const SkyPicture& picture, std::uint32_t most);

}  // namespace simvis
