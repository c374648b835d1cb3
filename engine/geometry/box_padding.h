// How far the boxes of trees over items are padded, and when such a tree is built anew: the same for every tree.
#pragma once

#include <glm/glm.hpp>

#include "engine/geometry/bvh.h"

namespace simvis {

/// A tree over items into which moved ones were fitted is built anew where a ray has to look into so many times the
/// boxes that it had to when it was built.
inline constexpr double kMaxSahCostRatio = 2;

/// By how much boxes are padded, as a share of the size of the coordinates in play: 32 half ulps of a float32.
inline constexpr double kPadding = 0x1p-19;

/// Boxes are cut here, so that products of their coordinates stay within float32.
inline constexpr double kFarthest = 1e18;

/// The box from `low` to `high`, grown by `padding` on every side.
Box padded_box(const glm::dvec3& low, const glm::dvec3& high, double padding);

}  // namespace simvis
