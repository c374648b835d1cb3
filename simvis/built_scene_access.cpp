#include "simvis/built_scene_access.h"

#include "simvis/simulation_impl.h"

namespace simvis {

const BuiltScene& BuiltSceneAccess::of(const Diagnostics& diagnostics) { return diagnostics.impl_->idle().scene.built; }

}  // namespace simvis
