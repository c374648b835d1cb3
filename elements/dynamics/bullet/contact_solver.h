// How contacts act: compression, friction and restitution.
//
// Compression A contact ahead of the touch leaves the speed that closes its gap within the step. An overlap is mended
//             at a bounded speed, since Bullet mends it by the bodies' own speeds.
// Friction    Both directions are solved at once, and lie within the cone of the normal impulse after each pass. Bullet
//             solves one after the other, and leaves that of a contact that has lost its normal impulse in the passes.
// Restitution Poisson's hypothesis: the passes bring all contacts to rest first; then each that bounces gives back its
//             share of the impulse of the compression, with the friction that this allows. Stronge's hypothesis bounds
//             the work of the second part, so that no bounce creates energy.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "elements/dynamics/bullet/contact_algorithm.h"

namespace simvis {

/// A contact that bounces in this step.
struct Bounce {
  btManifoldPoint* point;
  double approach_m_s, restitution, distance_m;
};

/// Prepares the points for Bullet's solver, which must not see restitution. Returns those that bounce; they count as
/// touching until release_bounces().
std::vector<Bounce> prepare_contacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info);
void release_bounces(const std::vector<Bounce>& bounces);

/// The friction of a contact in the last step, on body a.
struct LastFriction {
  const btManifoldPoint* point;
  btVector3 impulse;
};
std::vector<LastFriction> last_friction(btPersistentManifold** manifolds, int count);

/// The share of the expansion that does at most this work, if the work of a share s is `linear` s + `square` s^2.
double expansion_share(double linear, double square, double budget);

template <typename Solver>
class ContactSolver : public Solver {
  static constexpr bool kHasLinks = std::is_base_of_v<btMultiBodyConstraintSolver, Solver>;

 protected:
  void convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) override {
    bounces_ = prepare_contacts(manifolds, count, info);
    const std::vector<LastFriction> last = last_friction(manifolds, count);
    Solver::convertContacts(manifolds, count, info);
    start_friction(last, this->m_tmpSolverContactConstraintPool, this->m_tmpSolverContactFrictionConstraintPool);
    if constexpr (kHasLinks) {
      start_friction(last, this->m_multiBodyNormalContactConstraints, this->m_multiBodyFrictionContactConstraints);
    }
  }

  btScalar solveSingleIteration(int iteration, btCollisionObject** bodies, int body_count,
                                btPersistentManifold** manifolds, int manifold_count, btTypedConstraint** constraints,
                                int constraint_count, const btContactSolverInfo& info, btIDebugDraw* draw) override {
    btScalar residual = 0;
    without_friction([&] {
      residual = Solver::solveSingleIteration(iteration, bodies, body_count, manifolds, manifold_count, constraints,
                                              constraint_count, info, draw);
    });
    return std::max<btScalar>(residual, solve_friction());
  }

  btScalar solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int body_count,
                                             btPersistentManifold** manifolds, int manifold_count,
                                             btTypedConstraint** constraints, int constraint_count,
                                             const btContactSolverInfo& info, btIDebugDraw* draw) override {
    const btScalar result = Solver::solveGroupCacheFriendlyIterations(bodies, body_count, manifolds, manifold_count,
                                                                      constraints, constraint_count, info, draw);
    if (bounces_.empty()) return result;
    const Compressed compressed = store_compression(info.m_timeStep);
    const double budget = give_impulses_back(compressed);
    release_bounces(bounces_);
    for (int i = 0; i < info.m_numIterations; ++i) {
      const btScalar residual = solveSingleIteration(i, bodies, body_count, manifolds, manifold_count, constraints,
                                                     constraint_count, info, draw);
      if (residual <= info.m_leastSquaresResidualThreshold) break;
    }
    bound_work(compressed, budget);
    return result;
  }

 private:
  // A row's impulse, and the relative speed of the surfaces along it before and after the compression.
  struct RowState {
    double impulse, free_speed, speed;
  };
  struct Compressed {
    std::vector<RowState> rows;
    std::vector<double> joint_impulses;
  };

  // All rows of contacts, in the same order each time.
  template <typename Visit>
  void visit_rows(Visit&& visit) {
    const auto visit_all = [&](auto& rows) {
      for (int i = 0; i < rows.size(); ++i) visit(rows[i]);
    };
    visit_all(this->m_tmpSolverContactConstraintPool);
    visit_all(this->m_tmpSolverContactFrictionConstraintPool);
    if constexpr (kHasLinks) {
      visit_all(this->m_multiBodyNormalContactConstraints);
      visit_all(this->m_multiBodyFrictionContactConstraints);
    }
  }
  // The rows along normals, with the bounces that they have, in the order of the manifolds.
  template <typename Visit>
  void visit_bounces(Visit&& visit) {
    const auto visit_all = [&](auto& rows, std::size_t first_row) {
      auto bounce = bounces_.begin();
      for (int i = 0; i < rows.size() && bounce != bounces_.end(); ++i) {
        if (static_cast<const btManifoldPoint*>(rows[i].m_originalContactPoint)->getDistance() != 0) continue;
        const auto found = std::find_if(
            bounce, bounces_.end(), [&](const Bounce& each) { return each.point == rows[i].m_originalContactPoint; });
        if (found == bounces_.end()) continue;
        visit(rows[i], *found, first_row + static_cast<std::size_t>(i));
        bounce = std::next(found);
      }
    };
    const auto& bodies = this->m_tmpSolverContactConstraintPool;
    visit_all(this->m_tmpSolverContactConstraintPool, 0);
    if constexpr (kHasLinks) {
      visit_all(this->m_multiBodyNormalContactConstraints,
                static_cast<std::size_t>(bodies.size() + this->m_tmpSolverContactFrictionConstraintPool.size()));
    }
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
    row.m_appliedImpulse = btScalar(row.m_appliedImpulse) + change;
  }
  void change_impulse(btMultiBodySolverConstraint& row, double change) {
    const auto apply = [&](btMultiBody* links, int jacobian, int velocity, int body, const btVector3& normal,
                           const btVector3& angular) {
      if (links != nullptr) {
        double* const unit = &this->m_data.m_deltaVelocitiesUnitImpulse[jacobian];
        links->setPosUpdated(false);
        links->applyDeltaVeeMultiDof2(unit, change);
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

  // Hides the rows of friction from Bullet, which solves one direction after the other.
  template <typename Solve>
  void without_friction(Solve&& solve) {
    const int bodies = this->m_tmpSolverContactFrictionConstraintPool.size();
    this->m_tmpSolverContactFrictionConstraintPool.resizeNoInitialize(0);
    int links = 0;
    if constexpr (kHasLinks) {
      links = this->m_multiBodyFrictionContactConstraints.size();
      this->m_multiBodyFrictionContactConstraints.resizeNoInitialize(0);
    }
    solve();
    this->m_tmpSolverContactFrictionConstraintPool.resizeNoInitialize(bodies);
    if constexpr (kHasLinks) this->m_multiBodyFrictionContactConstraints.resizeNoInitialize(links);
  }

  // Begins with the friction of the last step. Its directions may have been others.
  template <typename Rows>
  void start_friction(const std::vector<LastFriction>& last, const Rows& normals, Rows& rows) {
    auto next = last.begin();
    for (int i = 0; i + 1 < rows.size() && next != last.end(); i += 2) {
      const auto found = std::find_if(next, last.end(), [&](const LastFriction& each) {
        return each.point == normals[rows[i].m_frictionIndex].m_originalContactPoint;
      });
      if (found == last.end()) continue;
      next = std::next(found);
      for (const int k : {i, i + 1}) change_impulse(rows[k], found->impulse.dot(rows[k].m_contactNormal1));
    }
  }

  // Returns the square of the largest change of speed.
  double solve_friction() {
    double largest = 0;
    const auto solve_all = [&](const auto& normals, auto& rows) {
      for (int i = 0; i + 1 < rows.size(); i += 2) {
        const double normal = btScalar(normals[rows[i].m_frictionIndex].m_appliedImpulse);
        largest = std::max(largest, solve_friction(rows[i], rows[i + 1], std::max(0.0, normal)));
      }
    };
    solve_all(this->m_tmpSolverContactConstraintPool, this->m_tmpSolverContactFrictionConstraintPool);
    if constexpr (kHasLinks) {
      solve_all(this->m_multiBodyNormalContactConstraints, this->m_multiBodyFrictionContactConstraints);
    }
    return largest * largest;
  }

  // Both directions at once and with one mass, so that friction points against the sliding.
  template <typename Row>
  double solve_friction(Row& along, Row& across, double normal_impulse) {
    const double most = along.m_friction * normal_impulse, mass = std::min(along.m_jacDiagABInv, across.m_jacDiagABInv);
    const double old_along = btScalar(along.m_appliedImpulse), old_across = btScalar(across.m_appliedImpulse);
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

  Compressed store_compression(double step_s) {
    Compressed compressed;
    visit_rows([&](const auto& row) {
      const double inverse_mass = row.m_jacDiagABInv > 0 ? 1 / row.m_jacDiagABInv : 0;
      const auto* const point = static_cast<const btManifoldPoint*>(row.m_originalContactPoint);
      const bool is_normal = row.m_lowerLimit == 0 && row.m_upperLimit > 1e9;
      const double gap = is_normal ? std::max(0.0, point->getDistance()) / step_s : 0;
      const double free_speed = -row.m_rhs * inverse_mass - gap;
      compressed.rows.push_back({btScalar(row.m_appliedImpulse), free_speed, free_speed + speed_change(row)});
    });
    if constexpr (kHasLinks) {
      for (int i = 0; i < this->m_multiBodyNonContactConstraints.size(); ++i) {
        compressed.joint_impulses.push_back(this->m_multiBodyNonContactConstraints[i].m_appliedImpulse);
      }
    }
    return compressed;
  }

  // Raises the least impulse of each contact that bounces. Returns the work that all may do. The speed that gravity
  // gave within this step does not come back.
  double give_impulses_back(const Compressed& compressed) {
    double budget = 0;
    visit_bounces([&](auto& row, const Bounce& bounce, std::size_t index) {
      const RowState& state = compressed.rows[index];
      if (!(state.free_speed < 0)) return;
      const double share = bounce.restitution * std::clamp(-bounce.approach_m_s / state.free_speed, 0.0, 1.0);
      row.m_lowerLimit = (1 + share) * state.impulse;
      budget += share * share * std::max(0.0, -state.impulse * (state.free_speed + state.speed) / 2);
    });
    return budget;
  }

  void bound_work(const Compressed& compressed, double budget) {
    double linear = 0, square = 0;
    std::size_t next = 0;
    visit_rows([&](const auto& row) {
      const RowState& before = compressed.rows[next++];
      const double impulse = btScalar(row.m_appliedImpulse) - before.impulse;
      linear += impulse * before.speed;
      square += impulse * (before.free_speed + speed_change(row) - before.speed) / 2;
    });
    const double share = expansion_share(linear, square, budget);
    if (share < 1) keep_share(compressed, share);
  }

  void keep_share(const Compressed& compressed, double share) {
    std::size_t next = 0;
    visit_rows([&](auto& row) {
      const double impulse = btScalar(row.m_appliedImpulse);
      change_impulse(row, (share - 1) * (impulse - compressed.rows[next++].impulse));
    });
    if constexpr (kHasLinks) {
      for (int i = 0; i < this->m_multiBodyNonContactConstraints.size(); ++i) {
        btMultiBodySolverConstraint& row = this->m_multiBodyNonContactConstraints[i];
        change_impulse(row,
                       (share - 1) * (row.m_appliedImpulse - compressed.joint_impulses[static_cast<std::size_t>(i)]));
      }
    }
  }

  std::vector<Bounce> bounces_;
};

}  // namespace simvis
