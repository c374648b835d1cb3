// What elements do between two frames.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <simvis/frame_time.h>
#include "engine/base/program_api.h"
#include "simvis/built_scene.h"

namespace simvis {

/// Gives elements the values that have changed.
void update_elements(BuiltScene& built);

/// Draws the parameters of elements of type `randomize` and gives elements the values of this frame; then those that
/// move by themselves write theirs. Throws what Element::advance() throws.
void advance_elements(BuiltScene& built, const FrameTime& time);

/// A parameter that an element of type `randomize` draws.
struct DrawnValue {
  std::string element, parameter;
  double value = 0;
};
/// The values that are drawn for a frame, in the order of the commands.
SIMVIS_PROGRAM_API std::vector<DrawnValue> drawn_values(const BuiltScene& built, std::uint64_t frame);

/// Whether the scene has an element that moves by itself.
bool has_motion(const BuiltScene& built);

}  // namespace simvis
