// Two frames, of bodies, of links or of the world, that stay one.
#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>

namespace simvis {

/// A frame of a link or of a rigid body. It is a frame of the world if both pointers are null.
struct ConstrainedFrame {
  btMultiBody* links = nullptr;
  int link = -1;
  btRigidBody* rigid = nullptr;
  btTransform frame_from_joint =
      btTransform::getIdentity();  ///< in Bullet's frame of the link or body; of the world: world_from_joint

  btTransform world_from_joint() const;
  int island() const;  ///< -1: it has none, since nothing moves it
  int solver_body(const btMultiBodyJacobianData& data) const;
};

/// Six rows: three hold the place, three the attitude. Their impulses act on both sides at one place, so that they
/// change neither the momentum nor the angular momentum of both together.
class FixedConstraint : public btMultiBodyConstraint {
 public:
  FixedConstraint(const ConstrainedFrame& a, const ConstrainedFrame& b);
  void finalizeMultiDof() override {}
  int getIslandIdA() const override { return a_.island(); }
  int getIslandIdB() const override { return b_.island(); }
  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                            const btContactSolverInfo& info) override;
  void debugDraw(btIDebugDraw*) override {}

 private:
  ConstrainedFrame a_, b_;
};

}  // namespace simvis
