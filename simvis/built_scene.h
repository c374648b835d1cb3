// What a simulation has built of its scene and when its frames come, for programs that list, show or run it.
#pragma once

#include <cstdint>

#include "engine/base/program_api.h"
#include "simvis/scene_builder.h"

namespace simvis {

class Simulation;

/// Valid as long as the simulation, and until the next execute(). Throws InputError while a frame is under way.
SIMVIS_PROGRAM_API const BuiltScene& built_scene(const Simulation& simulation);

/// The same, after the elements have taken the values that were set since the last step.
SIMVIS_PROGRAM_API const BuiltScene& updated_scene(Simulation& simulation);

/// From the next step on, all shapes and pictures of parts are read, also those that no sensor needs: for programs that
/// show the draw list. That step throws InputError if one of them cannot be read.
SIMVIS_PROGRAM_API void read_all_content(Simulation& simulation);

/// The number of frames that come from now on until `end_ns`, as Timeline::frames_until().
SIMVIS_PROGRAM_API std::uint64_t frames_until(const Simulation& simulation, std::int64_t end_ns);

}  // namespace simvis
