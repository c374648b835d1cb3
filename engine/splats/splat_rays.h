// What rays from one viewpoint see of splats: their colour, how much shines through them, and where half of it does.
//
// Along a ray, splats follow each other by the range of their peaks (see seen_splats.h), and splats at one range by
// what they look like. So the result depends neither on the order of the splats nor on the number of threads. Each
// stops the share alpha of the light that reaches it (Porter and Duff 1984: over), and what shines through all of them,
// the transmittance, is the product of all 1 - alpha.
//
// Half     Outputs of one surface for each ray, such as depth, are those of the first splat behind which the
//          transmittance is at most a half.
// Colour   Colours of one encoding are mixed in this encoding, as splats are trained, and the mixture is decoded as one
//          colour. Its weight, the share of light that these splats stop, counts in linear light.
// End      Behind a transmittance below 1e-4 nothing is looked at.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "engine/base/thread_pool.h"
#include "engine/splats/seen_splats.h"
#include "engine/splats/splat_mixture.h"

namespace simvis {

/// Rays of some rows of an image, by pixel of these rows: [y * width + x].
struct SplatRays {
  std::uint32_t width_px = 0;
  std::span<const glm::dvec3> directions;  ///< V, unit length; zero: no ray
  std::span<const double> near_m;          ///< splats at or before this range are not seen
  std::span<const double> end_m;           ///< splats at or behind this range are hidden; +infinity: none
};

/// Sets sights[i] of each ray. The same bytes for any pool.
void see_through(std::span<const SeenSplat> splats, const SplatRays& rays, ThreadPool& pool,
                 std::span<SplatSight> sights);

}  // namespace simvis
