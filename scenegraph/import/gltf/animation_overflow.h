// Whether an animation can move something to where numbers end: asked once, when its file is read.
#pragma once

#include <string>

#include "scenegraph/part_animation.h"

namespace simvis {

/// What the clips may move to where float32 is not finite: "a node", say; empty when every node and vertex stays finite
/// at every time. An upper bound decides, in one pass: the lengths of translations and tangents, the largest scales and
/// weights of all clips, multiplied along the tree. So what passes never overflows.
std::string animation_overflow(const PartAnimations& animations);

}  // namespace simvis
