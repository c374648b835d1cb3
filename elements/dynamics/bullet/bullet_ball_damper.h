// Damping of a ball joint that acts on the speed at the end of a step.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

namespace simvis {

/// Holds the three speeds of a ball at 0 as softly as the damping says: each impulse in a step h is -damping * h *
/// speed. A soft constraint with the compliance 1 / (damping * h) is that.
class BulletBallDamper : public btMultiBodyConstraint {
 public:
  BulletBallDamper(btMultiBody& body, int link, double damping, double step_s)
      : btMultiBodyConstraint(&body, &body, link, body.getParent(link), kAxes, false, kBallDamper),
        compliance_(1 / (damping * step_s)) {}

  void finalizeMultiDof() override {
    allocateJacobiansMultiDof();
    const int first = 6 + getMultiBodyA()->getLink(getLinkA()).m_dofOffset;
    for (int i = 0; i < kAxes; ++i) jacobianA(i)[first + i] = 1;
    m_numDofsFinalized = m_jacSizeBoth;
  }
  int getIslandIdA() const override { return island_of(getLinkA()); }
  int getIslandIdB() const override { return island_of(getLinkB()); }
  void debugDraw(btIDebugDraw*) override {}
  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                            const btContactSolverInfo& info) override {
    if (m_numDofsFinalized != m_jacSizeBoth) finalizeMultiDof();
    const btVector3 none(0, 0, 0);
    for (int i = 0; i < kAxes; ++i) {
      btMultiBodySolverConstraint& row = rows.expandNonInitializing();
      fillMultiBodyConstraint(row, data, jacobianA(i), nullptr, none, none, none, none, 0, info, -BT_LARGE_FLOAT,
                              BT_LARGE_FLOAT);
      row.m_orgConstraint = this;
      row.m_orgDofIndex = i;
      soften(row);
    }
  }

 private:
  static constexpr int kAxes = 3, kBallDamper = MULTIBODY_CONSTRAINT_1DOF_JOINT_MOTOR;
  int island_of(int link) const {
    const btMultiBodyLinkCollider* const collider =
        link < 0 ? m_bodyA->getBaseCollider() : m_bodyA->getLink(link).m_collider;
    return collider == nullptr ? -1 : collider->getIslandTag();
  }
  void soften(btMultiBodySolverConstraint& row) const {
    const double stiff = row.m_jacDiagABInv, soft = 1 / (1 / stiff + compliance_);
    row.m_rhs *= soft / stiff;
    row.m_jacDiagABInv = soft;
    row.m_cfm = compliance_ * soft;
  }
  double compliance_;
};

}  // namespace simvis
