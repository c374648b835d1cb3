// Checks when a file is read whether its animations can leave the range of float32.
#pragma once

#include <string>

#include "scenegraph/part_animation.h"

namespace simvis {

/// Returns what the clips may move beyond the range of float32, for example "a node". Returns an empty string if every
/// node and vertex stays finite at every time. One pass computes an upper bound: the lengths of translations and
/// tangents, the largest scales and weights of all clips, multiplied along the tree. A file that passes this check
/// never overflows.
std::string animation_overflow(const PartAnimations& animations);

}  // namespace simvis
