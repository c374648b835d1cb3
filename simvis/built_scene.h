// What a simulation has built of its scene, for clients that list it.
#pragma once

#include "engine/base/program_api.h"
#include "simvis/scene_builder.h"

namespace simvis {

class Simulation;

/// Valid as long as the simulation, and until the next execute(). Throws InputError while a frame is under way.
SIMVIS_PROGRAM_API const BuiltScene& built_scene(const Simulation& simulation);

}  // namespace simvis
