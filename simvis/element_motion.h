// What elements do between two frames.
#pragma once

#include <simvis/frame_time.h>
#include "simvis/built_scene.h"

namespace simvis {

/// Gives elements the values that have changed.
void update_elements(BuiltScene& built);

/// Gives elements the values that were set for this frame; then those that move by themselves write theirs. Throws what
/// Element::advance() throws.
void advance_elements(BuiltScene& built, const FrameTime& time);

/// Whether the scene has an element that moves by itself.
bool has_motion(const BuiltScene& built);

}  // namespace simvis
