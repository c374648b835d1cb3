// The scene of a running simulation, for what the program shows of it while it runs.
#pragma once

#include <simvis/diagnostics.h>
#include "engine/base/program_api.h"
#include "simvis/scene_builder.h"

namespace simvis {

struct BuiltSceneAccess {
  /// Valid as long as the simulation; its content changes with steps and commands. Throws InputError while a frame is
  /// under way.
  SIMVIS_PROGRAM_API static const BuiltScene& of(const Diagnostics& diagnostics);
};

}  // namespace simvis
