// The padding of boxes in trees over items, and the threshold for rebuilding such a tree; both are common to all trees.
#pragma once

#include <glm/glm.hpp>

#include "engine/geometry/bvh.h"

namespace simvis {

/// A tree over items that was refitted to moved items is rebuilt when its sah_cost() exceeds this multiple of the cost
/// at the last build.
inline constexpr double kMaxSahCostRatio = 2;

/// Padding of boxes, relative to the size of the coordinates involved: 32 half ulps of a float32.
inline constexpr double kPadding = 0x1p-19;

/// Coordinates of boxes are clamped to this magnitude, so that their products stay within float32.
inline constexpr double kFarthest = 1e18;

/// The box from `low` to `high`, grown by `padding` on every side.
Box padded_box(const glm::dvec3& low, const glm::dvec3& high, double padding);

}  // namespace simvis
