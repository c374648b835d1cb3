// A body with joints: Bullet's btMultiBody, in joint coordinates.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <memory>
#include <vector>

#include "dynamics/bullet/bullet_shape.h"
#include "dynamics/world.h"

namespace simvis {

class BulletArticulation {
 public:
  /// `id` is what its colliders carry as their user index.
  BulletArticulation(const ArticulationDesc& desc, btMultiBodyDynamicsWorld& world, double step_s, int id);
  ~BulletArticulation();
  BulletArticulation(const BulletArticulation&) = delete;
  BulletArticulation& operator=(const BulletArticulation&) = delete;

  void move(const glm::dmat4& world_from_base);
  void drive(std::size_t link, const JointDrive& drive);
  void place_joint(std::size_t link, double position);
  /// Before each step: what holds for one step only.
  void apply();
  bool may_go_on() const;
  BodyState base() const;
  JointState joint(std::size_t link) const;

 private:
  struct Link {
    btTransform frame_from_link;  // from the link's frame to Bullet's: centre of mass, principal axes
    bool moves = false;
    double damping = 0;
    JointDrive drive;
    std::unique_ptr<BulletShape> shape;
    std::unique_ptr<btMultiBodyLinkCollider> collider;
    std::unique_ptr<btMultiBodyJointLimitConstraint> limit;
    std::unique_ptr<btMultiBodyJointMotor> motor;
  };
  void add_link(int index, const LinkDesc& desc);
  void add_collider(int link, std::span<const CollisionShape> shapes, const SurfaceProperties& surface, Link& own,
                    int id);
  void place_colliders();

  btMultiBodyDynamicsWorld& world_;
  double step_s_;
  bool fixed_base_;
  std::unique_ptr<btMultiBody> body_;
  Link base_;
  std::vector<Link> links_;
};

/// Bullet's frame of a body: its origin is the centre of mass, its axes are those of the inertia.
struct BulletFrame {
  btTransform frame_from_body;
  btVector3 inertia;
};
BulletFrame bullet_frame(const MassProperties& mass);

}  // namespace simvis
