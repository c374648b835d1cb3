#include "elements/sensed_physics.h"

namespace simvis {

std::shared_ptr<SensedPhysics> find_physics(const Scene& scene) {
  for (const NodePtr& child : scene.root()->children()) {
    if (auto physics = std::dynamic_pointer_cast<SensedPhysics>(child)) return physics;
  }
  return nullptr;
}

}  // namespace simvis
