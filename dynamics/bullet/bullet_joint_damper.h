// Damping of a joint that acts on the speed at the end of a step.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>

namespace simvis {

/// Makes a row that holds the speed 0 as soft as a damping says: its impulse in a step h is -damping * h * speed. A
/// soft constraint with the compliance 1 / (damping * h) is that.
inline void soften_damper(btMultiBodySolverConstraint& row, double compliance) {
  const double stiff = row.m_jacDiagABInv, soft = 1 / (1 / stiff + compliance);
  row.m_rhs *= soft / stiff;
  row.m_jacDiagABInv = soft;
  row.m_cfm = compliance * soft;
}

class BulletJointDamper : public btMultiBodyJointMotor {
 public:
  BulletJointDamper(btMultiBody& body, int link, double damping, double step_s)
      : btMultiBodyJointMotor(&body, link, 0, BT_LARGE_FLOAT), compliance_(1 / (damping * step_s)) {}
  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                            const btContactSolverInfo& info) override {
    const int first = rows.size();
    btMultiBodyJointMotor::createConstraintRows(rows, data, info);
    for (int i = first; i < rows.size(); ++i) soften_damper(rows[i], compliance_);
  }

 private:
  double compliance_;
};

/// The same about the three axes of a ball.
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
      soften_damper(row, compliance_);
    }
  }

 private:
  static constexpr int kAxes = 3, kBallDamper = MULTIBODY_CONSTRAINT_1DOF_JOINT_MOTOR;
  int island_of(int link) const {
    const btMultiBodyLinkCollider* const collider =
        link < 0 ? m_bodyA->getBaseCollider() : m_bodyA->getLink(link).m_collider;
    return collider == nullptr ? -1 : collider->getIslandTag();
  }
  double compliance_;
};

}  // namespace simvis
