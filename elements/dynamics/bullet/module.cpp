// What the library finds in this module; see elements/dynamics/world/engine_module.h.
#include "elements/dynamics/bullet/bullet_shape.h"
#include "elements/dynamics/bullet/bullet_world.h"
#include "elements/dynamics/bullet/convex_pieces.h"

namespace simvis {
namespace {

class BulletEngine : public DynamicsEngine {
 public:
  std::unique_ptr<DynamicsWorld> make_world(const WorldDesc& desc) const override {
    return std::make_unique<BulletWorld>(desc);
  }
  std::optional<CollisionShape> convex_hull(std::span<const glm::dvec3> points) const override {
    return bullet_convex_hull(points);
  }
  std::vector<CollisionShape> convex_pieces(std::span<const glm::dvec3> points,
                                            std::span<const std::uint32_t> triangles,
                                            double concavity_m) const override {
    return bullet_convex_pieces(points, triangles, concavity_m);
  }
};

}  // namespace
}  // namespace simvis

extern "C" __attribute__((visibility("default"))) const simvis::DynamicsEngine* simvis_dynamics_engine();
const simvis::DynamicsEngine* simvis_dynamics_engine() {
  static const simvis::BulletEngine engine;
  return &engine;
}
