// Damping of a joint that acts on the speed at the end of a step.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>

namespace simvis {

/// A motor that holds the speed 0 as softly as the damping says: its impulse in a step h is -damping * h * speed. A
/// soft constraint with the compliance 1 / (damping * h) is that.
class BulletJointDamper : public btMultiBodyJointMotor {
 public:
  BulletJointDamper(btMultiBody& body, int link, double damping, double step_s)
      : btMultiBodyJointMotor(&body, link, 0, BT_LARGE_FLOAT), compliance_(1 / (damping * step_s)) {}
  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                            const btContactSolverInfo& info) override {
    const int first = rows.size();
    btMultiBodyJointMotor::createConstraintRows(rows, data, info);
    for (int i = first; i < rows.size(); ++i) soften(rows[i]);
  }

 private:
  void soften(btMultiBodySolverConstraint& row) const {
    const double stiff = row.m_jacDiagABInv, soft = 1 / (1 / stiff + compliance_);
    row.m_rhs *= soft / stiff;
    row.m_jacDiagABInv = soft;
    row.m_cfm = compliance_ * soft;
  }
  double compliance_;
};

}  // namespace simvis
