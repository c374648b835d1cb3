// The contacts of all pairs of shapes: one collision algorithm in place of Bullet's.
//
// Bullet finds contacts of boxes and triangles once they overlap, one for each triangle and step, and mends the overlap
// afterwards. This one finds all that may touch within the step, from the speeds of the bodies, so that the solver
// lets them touch and no more. Contacts are made anew in each step; impulses of the last step go over to the contact
// that is nearest.
#pragma once

#include <btBulletCollisionCommon.h>

#include <memory>

class btMultiBody;

namespace simvis {

class CollisionFilter;
class ContactManifolds;

/// The speed of a body's or link's centre, and how it turns. Links have those that set_link_speeds() gave.
struct ObjectMotion {
  btVector3 velocity, angular_velocity;
  btVector3 velocity_at(const btVector3& arm) const { return velocity + angular_velocity.cross(arm); }
};
ObjectMotion motion_of(const btCollisionObject& object);
/// How far any point of the body or link moves in a step, at most.
double way_in_step(const btCollisionObject& object, double step_s);
/// Gives the colliders of a jointed body the speeds of their links. Bullet leaves them at 0.
void set_link_speeds(btMultiBody& body);

/// The contacts of a pair's algorithm; null if the pair never has any.
ContactManifolds* manifolds_of(btCollisionAlgorithm& algorithm);

class ContactConfiguration : public btDefaultCollisionConfiguration {
 public:
  /// The filter says which shapes collide; it lives longer.
  explicit ContactConfiguration(const CollisionFilter& filter);
  ~ContactConfiguration() override;
  btCollisionAlgorithmCreateFunc* getCollisionAlgorithmCreateFunc(int shape_a, int shape_b) override;

 private:
  std::unique_ptr<btCollisionAlgorithmCreateFunc> create_;
};

}  // namespace simvis
