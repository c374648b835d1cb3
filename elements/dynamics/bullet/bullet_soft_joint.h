// Springs, dampers and rotors of joints. They act on the position and the speed at the end of a step, so that no
// stiffness and no damping makes them unstable.
//
// The impulse in a step h is -h (k (q + h v - rest) + c (v - speed)) - a (v - v0), where q is the position and v0 the
// speed before the step, v the speed after it, and a the inertia of the rotor. That is a constraint on v with the
// compliance 1 / (h w) and the target (c speed - k (q - rest) + a v0 / h) / w, where w = c + h k + a / h.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>

namespace simvis {

struct SoftJoint {
  double stiffness = 0, damping = 0, rotor_inertia = 0;  ///< one of them above 0
  double rest = 0, speed = 0;                            ///< where the spring rests, and the damper
  double min_effort = -BT_LARGE_FLOAT, max_effort = BT_LARGE_FLOAT;
};

class BulletSoftJoint : public btMultiBodyJointMotor {
 public:
  BulletSoftJoint(btMultiBody& body, int link, const SoftJoint& soft, double step_s)
      : btMultiBodyJointMotor(&body, link, 0, BT_LARGE_FLOAT), step_s_(step_s) {
    set(soft);
  }
  void set(const SoftJoint& soft) { soft_ = soft; }
  /// Before each step, if there is a rotor: the speed at the beginning of the step, before any force acts.
  void begin_step(double speed) { speed_before_ = speed; }
  void createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                            const btContactSolverInfo& info) override {
    const double rotor = soft_.rotor_inertia / step_s_, yields = soft_.damping + step_s_ * soft_.stiffness + rotor,
                 stretch = m_bodyA->getJointPos(m_linkA) - soft_.rest;
    setVelocityTarget((soft_.damping * soft_.speed - soft_.stiffness * stretch + rotor * speed_before_) / yields);
    const int first = rows.size();
    btMultiBodyJointMotor::createConstraintRows(rows, data, info);
    for (int i = first; i < rows.size(); ++i) {
      soften(rows[i], 1 / (step_s_ * yields));
      rows[i].m_lowerLimit = soft_.min_effort * step_s_;
      rows[i].m_upperLimit = soft_.max_effort * step_s_;
    }
  }

 private:
  static void soften(btMultiBodySolverConstraint& row, double compliance) {
    const double stiff = row.m_jacDiagABInv, soft = 1 / (1 / stiff + compliance);
    row.m_rhs *= soft / stiff;
    row.m_jacDiagABInv = soft;
    row.m_cfm = compliance * soft;
  }
  SoftJoint soft_;
  double step_s_;
  double speed_before_ = 0;
};

}  // namespace simvis
