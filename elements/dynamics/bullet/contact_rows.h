// The rows of a step, which are contacts and joints, and the passes that solve them.
//
// Order       Each pass takes the rows one after the other (Gauss and Seidel): normals, joints, then friction. Both
//             directions of a friction are solved at once, and lie within the cone of the normal impulse.
// Start       Each row begins with its impulse of the last step, so what rests stays solved.
// Accelerated See pass_acceleration.h.
// Impulses of links change the speeds in m_deltaVelocities only; apply_to_links() gives them to the bodies.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <vector>

#include "elements/dynamics/bullet/contact_manifolds.h"
#include "elements/dynamics/bullet/pass_acceleration.h"

namespace simvis {

/// The impulses of a contact in the last step, on body a.
struct LastImpulse {
  const btManifoldPoint* point;
  double normal;
  btVector3 friction;
};
std::vector<LastImpulse> last_impulses(btPersistentManifold** manifolds, int count);

template <typename Solver>
class ContactRows : public Solver {
 protected:
  static constexpr bool kHasLinks = std::is_base_of_v<btMultiBodyConstraintSolver, Solver>;

  // All rows of contacts, in the same order each time.
  template <typename Visit>
  void visit_contact_rows(Visit&& visit) {
    visit_all(this->m_tmpSolverContactConstraintPool, visit);
    visit_all(this->m_tmpSolverContactFrictionConstraintPool, visit);
    if constexpr (kHasLinks) {
      visit_all(this->m_multiBodyNormalContactConstraints, visit);
      visit_all(this->m_multiBodyFrictionContactConstraints, visit);
    }
  }
  // The same with the contact of each row.
  template <typename Visit>
  void visit_rows_of_contacts(Visit&& visit) {
    const auto visit_pools = [&](auto& normals, auto& frictions) {
      const auto point_of = [&](int normal) {
        return static_cast<const btManifoldPoint*>(normals[normal].m_originalContactPoint);
      };
      for (int i = 0; i < normals.size(); ++i) visit(normals[i], point_of(i));
      for (int i = 0; i < frictions.size(); ++i) visit(frictions[i], point_of(frictions[i].m_frictionIndex));
    };
    visit_pools(this->m_tmpSolverContactConstraintPool, this->m_tmpSolverContactFrictionConstraintPool);
    if constexpr (kHasLinks) {
      visit_pools(this->m_multiBodyNormalContactConstraints, this->m_multiBodyFrictionContactConstraints);
    }
  }
  template <typename Visit>
  void visit_joint_rows(Visit&& visit) {
    if constexpr (kHasLinks) visit_all(this->m_multiBodyNonContactConstraints, visit);
  }

  double speed_change(const btSolverConstraint& row) const {
    const auto of_body = [&](int id, const btVector3& normal, const btVector3& arm) {
      const btSolverBody& body = this->m_tmpSolverBodyPool[id];
      if (body.m_invMass.isZero()) return 0.0;
      return normal.dot(body.m_deltaLinearVelocity) + arm.dot(body.m_deltaAngularVelocity);
    };
    return of_body(row.m_solverBodyIdA, row.m_contactNormal1, row.m_relpos1CrossNormal) +
           of_body(row.m_solverBodyIdB, row.m_contactNormal2, row.m_relpos2CrossNormal);
  }
  double speed_change(const btMultiBodySolverConstraint& row) const {
    const auto of_body = [&](int id, const btVector3& normal, const btVector3& arm) {
      if (id < 0) return 0.0;
      const btSolverBody& body = this->m_tmpSolverBodyPool[id];
      return normal.dot(body.m_deltaLinearVelocity) + arm.dot(body.m_deltaAngularVelocity);
    };
    const auto of_links = [&](const btMultiBody& body, int jacobian, int velocity) {
      double sum = 0;
      for (int i = 0; i < body.getNumDofs() + 6; ++i) {
        sum += this->m_data.m_jacobians[jacobian + i] * this->m_data.m_deltaVelocities[velocity + i];
      }
      return sum;
    };
    return (row.m_multiBodyA != nullptr
                ? of_links(*row.m_multiBodyA, row.m_jacAindex, row.m_deltaVelAindex)
                : of_body(row.m_solverBodyIdA, row.m_contactNormal1, row.m_relpos1CrossNormal)) +
           (row.m_multiBodyB != nullptr ? of_links(*row.m_multiBodyB, row.m_jacBindex, row.m_deltaVelBindex)
                                        : of_body(row.m_solverBodyIdB, row.m_contactNormal2, row.m_relpos2CrossNormal));
  }

  void change_impulse(btSolverConstraint& row, double change) {
    const auto apply = [&](int id, const btVector3& normal, const btVector3& angular) {
      btSolverBody& body = this->m_tmpSolverBodyPool[id];
      if (!body.m_invMass.isZero()) body.internalApplyImpulse(normal * body.m_invMass, angular, change);
    };
    apply(row.m_solverBodyIdA, row.m_contactNormal1, row.m_angularComponentA);
    apply(row.m_solverBodyIdB, row.m_contactNormal2, row.m_angularComponentB);
    row.m_appliedImpulse += change;
  }
  void change_impulse(btMultiBodySolverConstraint& row, double change) {
    const auto apply = [&](btMultiBody* links, int jacobian, int velocity, int body, const btVector3& normal,
                           const btVector3& angular) {
      if (links != nullptr) {
        double* const unit = &this->m_data.m_deltaVelocitiesUnitImpulse[jacobian];
        this->applyDeltaVee(unit, change, velocity, links->getNumDofs() + 6);
      } else if (body >= 0) {
        btSolverBody& rigid = this->m_tmpSolverBodyPool[body];
        rigid.internalApplyImpulse(normal * rigid.internalGetInvMass(), angular, change);
      }
    };
    apply(row.m_multiBodyA, row.m_jacAindex, row.m_deltaVelAindex, row.m_solverBodyIdA, row.m_contactNormal1,
          row.m_angularComponentA);
    apply(row.m_multiBodyB, row.m_jacBindex, row.m_deltaVelBindex, row.m_solverBodyIdB, row.m_contactNormal2,
          row.m_angularComponentB);
    row.m_appliedImpulse += change;
  }

  // Gives the rows of friction the motion of their surfaces, and finds those with rollers.
  void move_surfaces() {
    move_surfaces(this->m_tmpSolverContactConstraintPool, this->m_tmpSolverContactFrictionConstraintPool,
                  body_rollers_);
    if constexpr (kHasLinks) {
      move_surfaces(this->m_multiBodyNormalContactConstraints, this->m_multiBodyFrictionContactConstraints,
                    link_rollers_);
    }
  }

  // Begins with the impulses of the last step. The directions of friction may have been others. Bullet has begun with
  // the normals of bodies.
  void start_contacts(const std::vector<LastImpulse>& last) {
    start_friction(last, this->m_tmpSolverContactConstraintPool, this->m_tmpSolverContactFrictionConstraintPool);
    if constexpr (kHasLinks) {
      visit_last(last, this->m_multiBodyNormalContactConstraints, this->m_multiBodyNormalContactConstraints, 1,
                 [&](auto& row, const LastImpulse& impulse) { change_impulse(row, impulse.normal); });
      start_friction(last, this->m_multiBodyNormalContactConstraints, this->m_multiBodyFrictionContactConstraints);
    }
  }
  // A row that a joint leaves out in this step, such as one of a limit, begins with 0 the next time.
  void start_joints() {
    if constexpr (kHasLinks) {
      visit_joint_rows([&](btMultiBodySolverConstraint& row) {
        const double last = row.m_orgConstraint->getAppliedImpulse(row.m_orgDofIndex);
        change_impulse(row, std::clamp<double>(last, row.m_lowerLimit, row.m_upperLimit));
      });
      for (int i = 0; i < this->m_tmpNumMultiBodyConstraints; ++i) {
        btMultiBodyConstraint& joint = *this->m_tmpMultiBodyConstraints[i];
        for (int k = 0; k < joint.getNumRows(); ++k) joint.internalSetAppliedImpulse(k, 0);
      }
    }
  }

  // Ends once no row changes its speed by more than the threshold. Otherwise the last passes settle, judge and follow
  // the last extrapolation.
  void solve_rows(const btContactSolverInfo& info) {
    for (int i = 0; i < info.m_numIterations; ++i) {
      if (i == kPlainPasses) acceleration_.start(impulses(), weights());
      const double change = solve_once();
      if (change * change <= info.m_leastSquaresResidualThreshold) return;
      if (i < kPlainPasses || i + 1 == info.m_numIterations) continue;
      if (acceleration_.go_on(impulses(), i + 3 < info.m_numIterations)) set_impulses();
    }
  }

  void apply_to_links() {
    if constexpr (kHasLinks) {
      applied_.clear();
      const auto apply = [&](btMultiBody* links, int velocity) {
        if (links == nullptr || std::ranges::find(applied_, velocity) != applied_.end()) return;
        applied_.push_back(velocity);
        links->applyDeltaVeeMultiDof2(&this->m_data.m_deltaVelocities[velocity], 1);
      };
      const auto apply_of = [&](const btMultiBodySolverConstraint& row) {
        apply(row.m_multiBodyA, row.m_deltaVelAindex);
        apply(row.m_multiBodyB, row.m_deltaVelBindex);
      };
      visit_joint_rows(apply_of);
      visit_all(this->m_multiBodyNormalContactConstraints, apply_of);
    }
  }

 private:
  // Most steps end within them.
  static constexpr int kPlainPasses = 4;

  template <typename Rows, typename Visit>
  static void visit_all(Rows& rows, Visit&& visit) {
    for (int i = 0; i < rows.size(); ++i) visit(rows[i]);
  }

  // The rows whose contact had impulses in the last step; `stride` rows belong to one contact.
  template <typename Rows, typename Visit>
  static void visit_last(const std::vector<LastImpulse>& last, const Rows& normals, Rows& rows, int stride,
                         Visit&& visit) {
    auto next = last.begin();
    for (int i = 0; i + stride <= rows.size() && next != last.end(); i += stride) {
      const int normal = stride == 1 ? i : rows[i].m_frictionIndex;
      const auto found = std::find_if(next, last.end(), [&](const LastImpulse& each) {
        return each.point == normals[normal].m_originalContactPoint;
      });
      if (found == last.end()) continue;
      next = std::next(found);
      for (int k = i; k < i + stride; ++k) visit(rows[k], *found);
    }
  }
  // A contact with rollers: its first row of friction, and the components of the rollers' axis along the directions of
  // its two rows of friction.
  struct Roller {
    int first_row;
    double along, across;
  };

  // Returns the direction of a row's impulse on body a.
  template <typename Row>
  static btVector3 direction_of(const Row& row) {
    const btVector3& on_a = row.m_contactNormal1;  // zero for a body that does not move
    return on_a.isZero() ? -row.m_contactNormal2 : on_a;
  }

  template <typename Rows>
  static void move_surfaces(const Rows& normals, Rows& rows, std::vector<Roller>& rollers) {
    rollers.clear();
    for (int i = 0; i + 1 < rows.size(); i += 2) {
      const auto* const point =
          static_cast<const btManifoldPoint*>(normals[rows[i].m_frictionIndex].m_originalContactPoint);
      const std::optional<MovingSurface> surface = moving_surface(*point);
      if (!surface) continue;
      const btVector3 along = direction_of(rows[i]), across = direction_of(rows[i + 1]);
      rows[i].m_rhs -= surface->slide.dot(along) * rows[i].m_jacDiagABInv;
      rows[i + 1].m_rhs -= surface->slide.dot(across) * rows[i + 1].m_jacDiagABInv;
      if (surface->roller_axis.isZero()) continue;
      rollers.push_back({i, surface->roller_axis.dot(along), surface->roller_axis.dot(across)});
    }
  }

  template <typename Rows>
  void start_friction(const std::vector<LastImpulse>& last, const Rows& normals, Rows& rows) {
    visit_last(last, normals, rows, 2, [&](auto& row, const LastImpulse& impulse) {
      change_impulse(row, impulse.friction.dot(direction_of(row)));
    });
  }

  // Each returns the change of speed, without a sign.
  template <typename Row>
  double solve_row(Row& row) {
    const double old = row.m_appliedImpulse, mass = row.m_jacDiagABInv;
    const double wanted = old + row.m_rhs - old * row.m_cfm - mass * speed_change(row);
    const double change = std::clamp<double>(wanted, row.m_lowerLimit, row.m_upperLimit) - old;
    if (change == 0) return 0;
    change_impulse(row, change);
    return mass > 0 ? std::abs(change) / mass : 0;
  }
  // Both directions at once and with one mass, so that friction points against the sliding.
  template <typename Row>
  double solve_friction(Row& along, Row& across, double normal_impulse) {
    const double most = along.m_friction * normal_impulse, mass = std::min(along.m_jacDiagABInv, across.m_jacDiagABInv);
    const double old_along = along.m_appliedImpulse, old_across = across.m_appliedImpulse;
    if (!(mass > 0) || (most == 0 && old_along == 0 && old_across == 0)) return 0;
    const auto wanted = [&](const Row& row, double old) {
      return old + mass * (row.m_rhs / row.m_jacDiagABInv - speed_change(row));
    };
    const double new_along = wanted(along, old_along), new_across = wanted(across, old_across);
    const double size2 = new_along * new_along + new_across * new_across;
    const double share = size2 > most * most ? most / std::sqrt(size2) : 1;
    const double change_along = share * new_along - old_along, change_across = share * new_across - old_across;
    change_impulse(along, change_along);
    change_impulse(across, change_across);
    return std::max(std::abs(change_along), std::abs(change_across)) / mass;
  }

  // Along the axis of the rollers only.
  template <typename Row>
  double solve_roller(Row& along, Row& across, const Roller& roller, double normal_impulse) {
    const double most = along.m_friction * normal_impulse, mass = std::min(along.m_jacDiagABInv, across.m_jacDiagABInv);
    const double old_along = along.m_appliedImpulse, old_across = across.m_appliedImpulse;
    if (!(mass > 0) || (most == 0 && old_along == 0 && old_across == 0)) return 0;
    const auto missing_speed = [&](const Row& row) { return row.m_rhs / row.m_jacDiagABInv - speed_change(row); };
    const double missing = roller.along * missing_speed(along) + roller.across * missing_speed(across);
    const double impulse =
        std::clamp(roller.along * old_along + roller.across * old_across + mass * missing, -most, most);
    const double change_along = impulse * roller.along - old_along,
                 change_across = impulse * roller.across - old_across;
    change_impulse(along, change_along);
    change_impulse(across, change_across);
    return std::max(std::abs(change_along), std::abs(change_across)) / mass;
  }

  double solve_once() {
    double largest = 0;
    const auto solve = [&](auto& row) { largest = std::max(largest, solve_row(row)); };
    const auto solve_frictions = [&](const auto& normals, auto& rows, const std::vector<Roller>& rollers) {
      auto roller = rollers.begin();
      for (int i = 0; i + 1 < rows.size(); i += 2) {
        const double normal = std::max<double>(0, normals[rows[i].m_frictionIndex].m_appliedImpulse);
        const bool rolls = roller != rollers.end() && roller->first_row == i;
        largest = std::max(largest, rolls ? solve_roller(rows[i], rows[i + 1], *roller++, normal)
                                          : solve_friction(rows[i], rows[i + 1], normal));
      }
    };
    visit_all(this->m_tmpSolverContactConstraintPool, solve);
    visit_joint_rows(solve);
    if constexpr (kHasLinks) visit_all(this->m_multiBodyNormalContactConstraints, solve);
    solve_frictions(this->m_tmpSolverContactConstraintPool, this->m_tmpSolverContactFrictionConstraintPool,
                    body_rollers_);
    if constexpr (kHasLinks) {
      solve_frictions(this->m_multiBodyNormalContactConstraints, this->m_multiBodyFrictionContactConstraints,
                      link_rollers_);
    }
    return largest;
  }

  std::vector<double>& impulses() {
    impulses_.clear();
    const auto add = [&](const auto& row) { impulses_.push_back(row.m_appliedImpulse); };
    visit_contact_rows(add);
    visit_joint_rows(add);
    return impulses_;
  }
  // Sets those of impulses_. Finds the speeds anew: the passes would never correct an error of theirs, which
  // extrapolations multiply.
  void set_impulses() {
    visit_all(this->m_tmpSolverBodyPool, [](btSolverBody& body) {
      body.m_deltaLinearVelocity.setZero();
      body.m_deltaAngularVelocity.setZero();
    });
    if constexpr (kHasLinks) visit_all(this->m_data.m_deltaVelocities, [](double& speed) { speed = 0; });
    auto next = impulses_.begin();
    const auto set = [&](auto& row) {
      row.m_appliedImpulse = 0;
      change_impulse(row, *next++);
    };
    visit_contact_rows(set);
    visit_joint_rows(set);
  }
  // An impulse counts by its energy.
  const std::vector<double>& weights() {
    weights_.clear();
    const auto add = [&](const auto& row) { weights_.push_back(row.m_jacDiagABInv > 0 ? 1 / row.m_jacDiagABInv : 0); };
    visit_contact_rows(add);
    visit_joint_rows(add);
    return weights_;
  }

  std::vector<Roller> body_rollers_, link_rollers_;  // of this step, in the order of their rows
  std::vector<double> impulses_, weights_;
  PassAcceleration acceleration_;
  std::vector<int> applied_;
};

}  // namespace simvis
