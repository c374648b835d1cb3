// Finds the engine behind world.h, in a module that is loaded when the first scene asks for it.
#pragma once

#include "elements/dynamics/world/world.h"

namespace simvis {

/// The module's C function that returns the engine, which lives as long as the program.
inline constexpr const char* kDynamicsEngineSymbol = "simvis_dynamics_engine";

/// The engine. The first call loads lib/simvis/simvis-dynamics.so with its libraries, for the rest of the program.
/// Throws MachineError naming the file if the module is missing, as in a build without Bullet, or does not load.
/// Threads   any.
const DynamicsEngine& dynamics_engine();

/// Whether dynamics_engine() has loaded the module.
bool dynamics_engine_is_loaded();

}  // namespace simvis
