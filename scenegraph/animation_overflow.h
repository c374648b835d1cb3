// Whether an animation can move something to where numbers end: asked once, when its file is read.
#pragma once

#include <string>

#include "scenegraph/part_animation.h"

namespace simvis {

/// What is moved too far, such as "can move a skinned mesh to where float32 is not finite", with the number of the clip
/// in `clip`; empty when every node, weight and vertex stays finite at every time. An upper bound decides: lengths of
/// translations and tangents, largest scales and weights, multiplied along the tree. So what passes never overflows.
std::string animation_overflow(const PartAnimations& animations, std::size_t& clip);

}  // namespace simvis
