#include "elements/dynamics/bullet/fixed_constraint.h"

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>
#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>

namespace simvis {
namespace {

constexpr int kRows = 6;
// The share of an error of place or attitude that a step takes back, as in Bullet's joints. What is put elsewhere comes
// back at these speeds.
constexpr double kTakenBack = 0.2, kMaxBack_m_s = 1, kMaxBack_rad_s = 5;

// The rotation from `b` to `a` as a vector, for small angles.
btVector3 turn_between(const btMatrix3x3& a, const btMatrix3x3& b) {
  btQuaternion turn;
  (a * b.transpose()).getRotation(turn);
  const double twice = turn.w() < 0 ? -2 : 2;
  return {twice * turn.x(), twice * turn.y(), twice * turn.z()};
}

// One side of a row: the indices of its link or its body in the solver, and the directions of the row's impulse there.
struct RowSide {
  int jacobian, solver_body;
  const btVector3 &normal, &angular;
};

// The speed of a side along a row, with what the forces of the step add to it. Bullet leaves these forces out for rigid
// bodies.
double speed_along(const RowSide& row, const ConstrainedFrame& side, const btVector3& anchor,
                   const btMultiBodyJacobianData& data) {
  if (side.links != nullptr) {
    double speed = 0;
    for (int i = 0; i < side.links->getNumDofs() + 6; ++i) {
      speed += data.m_jacobians[row.jacobian + i] * side.links->getVelocityVector()[i];
    }
    return speed;
  }
  if (side.rigid == nullptr) return 0;
  if (side.rigid->isStaticOrKinematicObject()) {
    const btVector3 arm = anchor - side.rigid->getWorldTransform().getOrigin();
    const btVector3& along = row.normal.isZero() ? row.angular : row.normal;
    return along.dot(row.normal.isZero() ? side.rigid->getAngularVelocity() : side.rigid->getVelocityInLocalPoint(arm));
  }
  const btSolverBody& body = data.m_solverBodyPool->at(row.solver_body);
  return row.normal.dot(body.m_linearVelocity + body.m_externalForceImpulse) +
         row.angular.dot(body.m_angularVelocity + body.m_externalTorqueImpulse);
}

}  // namespace

btTransform ConstrainedFrame::world_from_joint() const {
  if (links != nullptr) {
    return btTransform(links->localFrameToWorld(link, frame_from_joint.getBasis()),
                       links->localPosToWorld(link, frame_from_joint.getOrigin()));
  }
  return rigid != nullptr ? rigid->getWorldTransform() * frame_from_joint : frame_from_joint;
}

int ConstrainedFrame::island() const {
  if (rigid != nullptr) return rigid->getIslandTag();
  if (links == nullptr) return -1;
  const btMultiBodyLinkCollider* const collider = link < 0 ? links->getBaseCollider() : links->getLink(link).m_collider;
  if (collider != nullptr) return collider->getIslandTag();
  for (int i = 0; i < links->getNumLinks(); ++i) {
    if (links->getLink(i).m_collider != nullptr) return links->getLink(i).m_collider->getIslandTag();
  }
  return -1;
}

int ConstrainedFrame::solver_body(const btMultiBodyJacobianData& data) const {
  const bool is_moved = rigid != nullptr && !rigid->isStaticOrKinematicObject();
  return is_moved ? rigid->getCompanionId() : data.m_fixedBodyId;
}

FixedConstraint::FixedConstraint(const ConstrainedFrame& a, const ConstrainedFrame& b)
    : btMultiBodyConstraint(a.links, b.links, a.link, b.link, kRows, false, MULTIBODY_CONSTRAINT_FIXED), a_(a), b_(b) {
  m_data.resize(kRows, 0);  // the impulses of the last step
}

void FixedConstraint::createConstraintRows(btMultiBodyConstraintArray& rows, btMultiBodyJacobianData& data,
                                           const btContactSolverInfo& info) {
  const btTransform a = a_.world_from_joint(), b = b_.world_from_joint();
  const btVector3 anchor = b.getOrigin(), away = a.getOrigin() - anchor,
                  turn = turn_between(a.getBasis(), b.getBasis());
  for (int i = 0; i < kRows; ++i) {
    const bool is_angular = i >= 3;
    btVector3 axis(0, 0, 0), none(0, 0, 0);
    axis[i % 3] = 1;
    btMultiBodySolverConstraint& row = rows.expandNonInitializing();
    row.m_orgConstraint = this;
    row.m_orgDofIndex = i;
    row.m_solverBodyIdA = a_.solver_body(data);
    row.m_solverBodyIdB = b_.solver_body(data);
    fillMultiBodyConstraint(row, data, nullptr, nullptr, is_angular ? axis : none, is_angular ? none : axis, anchor,
                            anchor, 0, info, -BT_LARGE_FLOAT, BT_LARGE_FLOAT, is_angular);
    const double speed =
        speed_along({row.m_jacAindex, row.m_solverBodyIdA, row.m_contactNormal1, row.m_relpos1CrossNormal}, a_, anchor,
                    data) +
        speed_along({row.m_jacBindex, row.m_solverBodyIdB, row.m_contactNormal2, row.m_relpos2CrossNormal}, b_, anchor,
                    data);
    const double error = is_angular ? turn[i - 3] : away[i], limit = is_angular ? kMaxBack_rad_s : kMaxBack_m_s;
    const double back = std::clamp<double>(kTakenBack * error / info.m_timeStep, -limit, limit);
    row.m_rhs = -(speed + back) * row.m_jacDiagABInv;
  }
}

}  // namespace simvis
