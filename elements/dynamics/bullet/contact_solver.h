// How contacts act: compression, friction and restitution.
//
// Compression A contact ahead of the touch leaves the speed that closes its gap within the step. An overlap is mended
//             at a bounded speed, since Bullet mends it by the bodies' own speeds.
// Restitution Poisson's hypothesis: the passes bring all contacts to rest first; then each that bounces gives back its
//             share of the impulse of the compression, with the friction that this allows. Two bounds keep a bounce
//             from creating energy. Stronge's hypothesis bounds the work of the second part. And all impulses together
//             do no work by the mean of the speeds before the step and after it: what gravity adds to the speed within
//             the step of a bounce is no energy that may come back.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <vector>

#include "elements/dynamics/bullet/contact_algorithm.h"
#include "elements/dynamics/bullet/contact_rows.h"

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

/// The velocity of a contact's surface on a, relative to that on b, before the forces of the step: world frame, m/s.
struct ContactVelocity {
  const btManifoldPoint* point;
  btVector3 velocity;
};
/// Returns the velocities of all contacts, sorted by the addresses of their points, as velocity_of() needs them.
std::vector<ContactVelocity> contact_velocities(btPersistentManifold** manifolds, int count);
/// Returns the velocity of a contact, which must be among them.
const btVector3& velocity_of(const std::vector<ContactVelocity>& velocities, const btManifoldPoint* point);

/// The share of the expansion that does at most this work, if the work of a share s is `linear` s + `square` s^2.
double expansion_share(double linear, double square, double budget);

template <typename Solver>
class ContactSolver : public ContactRows<Solver> {
 protected:
  void convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) override {
    bounces_ = prepare_contacts(manifolds, count, info);
    if (!bounces_.empty()) velocities_ = contact_velocities(manifolds, count);
    const std::vector<LastImpulse> last = last_impulses(manifolds, count);
    Solver::convertContacts(manifolds, count, info);
    this->move_surfaces();
    this->start_contacts(last);
    this->start_joints();
  }

  btScalar solveGroupCacheFriendlyIterations(btCollisionObject**, int, btPersistentManifold**, int, btTypedConstraint**,
                                             int, const btContactSolverInfo& info, btIDebugDraw*) override {
    this->solve_rows(info);
    if (!bounces_.empty()) {
      const Compressed compressed = store_compression(info.m_timeStep);
      const double budget = give_impulses_back(compressed);
      release_bounces(bounces_);
      this->solve_rows(info);
      bound_work(compressed, budget);
    }
    this->apply_to_links();
    return 0;
  }

 private:
  // A row's impulse, and the relative speed of the surfaces along it: before the step, with what the forces of the step
  // add to it, and after the compression.
  struct RowState {
    double impulse, first_speed, free_speed, speed;
  };
  struct Compressed {
    std::vector<RowState> rows;
    std::vector<double> joint_impulses;
  };

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
    if constexpr (ContactRows<Solver>::kHasLinks) {
      visit_all(this->m_multiBodyNormalContactConstraints,
                static_cast<std::size_t>(bodies.size()) +
                    static_cast<std::size_t>(this->m_tmpSolverContactFrictionConstraintPool.size()));
    }
  }

  Compressed store_compression(double step_s) {
    Compressed compressed;
    this->visit_rows_of_contacts([&](const auto& row, const btManifoldPoint* point) {
      const double inverse_mass = row.m_jacDiagABInv > 0 ? 1 / row.m_jacDiagABInv : 0;
      const bool is_normal = row.m_lowerLimit == 0 && row.m_upperLimit > 1e9;
      const double gap = is_normal ? std::max(0.0, point->getDistance()) / step_s : 0;
      const double free_speed = -row.m_rhs * inverse_mass - gap;
      const btVector3& on_a = row.m_contactNormal1;  // zero for a body that stands
      const double first_speed = velocity_of(velocities_, point).dot(on_a.isZero() ? -row.m_contactNormal2 : on_a);
      compressed.rows.push_back({row.m_appliedImpulse, first_speed, free_speed, free_speed + this->speed_change(row)});
    });
    this->visit_joint_rows([&](const auto& row) { compressed.joint_impulses.push_back(row.m_appliedImpulse); });
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
    double linear = 0, square = 0, work = 0, mean_linear = 0;  // the latter two by the mean speeds
    std::size_t next = 0;
    this->visit_contact_rows([&](const auto& row) {
      const RowState& before = compressed.rows[next++];
      const double impulse = row.m_appliedImpulse - before.impulse;
      const double change = before.free_speed + this->speed_change(row) - before.speed;
      linear += impulse * before.speed;
      square += impulse * change / 2;
      work += before.impulse * (before.first_speed + before.speed) / 2;
      mean_linear += (impulse * (before.first_speed + before.speed) + before.impulse * change) / 2;
    });
    const double share =
        std::min(expansion_share(linear, square, budget), expansion_share(mean_linear, square, std::max(0.0, -work)));
    if (share < 1) keep_share(compressed, share);
  }

  void keep_share(const Compressed& compressed, double share) {
    std::size_t next = 0;
    this->visit_contact_rows([&](auto& row) {
      const double impulse = row.m_appliedImpulse;
      this->change_impulse(row, (share - 1) * (impulse - compressed.rows[next++].impulse));
    });
    next = 0;
    this->visit_joint_rows([&](auto& row) {
      this->change_impulse(row, (share - 1) * (row.m_appliedImpulse - compressed.joint_impulses[next++]));
    });
  }

  std::vector<Bounce> bounces_;
  std::vector<ContactVelocity> velocities_;  // if anything bounces
};

}  // namespace simvis
