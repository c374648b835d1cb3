// A lamp with a size: the lights that it is made of.
//
// Ball     Every point of its surface shines equally in all directions, as a globe of frosted glass nearly does. No
//          part of the ball hides another one. Behind a straight edge, the light of a ball that is far away falls
//          linearly, because equal parts of a ball's axis have equal surfaces (Archimedes).
// Disc     A disc in the sky of equal radiance, as the sun's without the darkening of its limb.
// Error    With n points, a penumbra consists of steps of 1 / n. The light beside an edge errs by less than
//          1 / (2 sqrt(n)) of the whole in the root mean square, which is the standard deviation of random points.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include <simvis/element.h>

namespace simvis {

struct Lamp {
  double radius = 0;         ///< metres of a ball, radians of a disc; 0: one light
  std::uint32_t points = 1;  ///< 1 without a size
};

/// Where point i of a ball is, in metres from its middle.
glm::dvec3 place_of_point(const Lamp& lamp, std::uint32_t i);

/// The way in which the light of point i of a disc travels, unit length. `direction` is that of its middle.
glm::dvec3 direction_of_point(const Lamp& lamp, const glm::dvec3& direction, std::uint32_t i);

/// Throws InputError, at the attribute `shadows` or else at `name`, if the scene has too many lights with shadows for
/// so many more.
void check_shadow_count(const ElementContext& context, std::uint32_t more);

}  // namespace simvis
