#include "elements/dynamics/bullet/contact_solver.h"

#include <functional>

namespace simvis {
namespace {

// Overlaps are mended at no more than this speed, which lifts a body by 0.05 mm afterwards; deep ones, under a load
// that the passes do not carry, at this rate.
constexpr double kMaxMending_m_s = 0.03, kDeepMending_per_s = 50;
// A smaller gap counts as closed. Otherwise what rests falls through it in one step, and begins the passes of the next
// one without its impulse: a heap would tremble forever.
constexpr double kClosedGap_m = 2e-5;

// Returns the velocity of the surface on a, relative to that on b.
btVector3 velocity_at(const btPersistentManifold& manifold, const btManifoldPoint& point) {
  const auto velocity = [](const btCollisionObject& object, const btVector3& at) {
    return motion_of(object).velocity_at(at - object.getWorldTransform().getOrigin());
  };
  const btVector3 of_bodies = velocity(*manifold.getBody0(), point.getPositionWorldOnA()) -
                              velocity(*manifold.getBody1(), point.getPositionWorldOnB());
  const std::optional<MovingSurface> surface = moving_surface(point);
  return surface ? of_bodies + surface->slide : of_bodies;
}

void mend_slowly(btManifoldPoint& point, const btContactSolverInfo& info) {
  const double overlap = -point.getDistance();
  point.m_contactPointFlags |= BT_CONTACT_FLAG_HAS_CONTACT_ERP;
  const double slow = kMaxMending_m_s + kDeepMending_per_s * overlap;
  point.m_contactERP = overlap > 0 ? std::min<double>(info.m_erp2, slow * info.m_timeStep / overlap) : info.m_erp2;
}

}  // namespace

std::vector<Bounce> prepare_contacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) {
  std::vector<Bounce> bounces;
  for (int i = 0; i < count; ++i) {
    for (int p = 0; p < manifolds[i]->getNumContacts(); ++p) {
      btManifoldPoint& point = manifolds[i]->getContactPoint(p);
      if (point.getDistance() > 0 && point.getDistance() < kClosedGap_m) point.setDistance(0);
      mend_slowly(point, info);
      const double restitution = point.m_combinedRestitution;
      point.m_combinedRestitution = 0;
      if (restitution <= 0) continue;
      const double approach = -point.m_normalWorldOnB.dot(velocity_at(*manifolds[i], point));
      if (approach < info.m_restitutionVelocityThreshold) continue;
      if (point.getDistance() > approach * info.m_timeStep) continue;
      bounces.push_back({&point, approach, restitution, point.getDistance()});
      point.m_distance1 = 0;
    }
  }
  return bounces;
}

void release_bounces(const std::vector<Bounce>& bounces) {
  for (const Bounce& bounce : bounces) bounce.point->m_distance1 = bounce.distance_m;
}

std::vector<LastImpulse> last_impulses(btPersistentManifold** manifolds, int count) {
  std::vector<LastImpulse> last;
  for (int i = 0; i < count; ++i) {
    for (int p = 0; p < manifolds[i]->getNumContacts(); ++p) {
      const btManifoldPoint& point = manifolds[i]->getContactPoint(p);
      last.push_back({&point, point.m_appliedImpulse,
                      point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                          point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2});
    }
  }
  return last;
}

std::vector<ContactVelocity> contact_velocities(btPersistentManifold** manifolds, int count) {
  std::vector<ContactVelocity> velocities;
  for (int i = 0; i < count; ++i) {
    for (int p = 0; p < manifolds[i]->getNumContacts(); ++p) {
      const btManifoldPoint& point = manifolds[i]->getContactPoint(p);
      velocities.push_back({&point, velocity_at(*manifolds[i], point)});
    }
  }
  std::ranges::sort(velocities, std::less<>(), &ContactVelocity::point);
  return velocities;
}

const btVector3& velocity_of(const std::vector<ContactVelocity>& velocities, const btManifoldPoint* point) {
  return std::ranges::lower_bound(velocities, point, std::less<>(), &ContactVelocity::point)->velocity;
}

double expansion_share(double linear, double square, double budget) {
  if (linear + square <= budget) return 1;
  if (!(square > 0)) return linear > 0 ? std::clamp(budget / linear, 0.0, 1.0) : 1;
  return std::clamp((std::sqrt(linear * linear + 4 * square * std::max(0.0, budget)) - linear) / (2 * square), 0.0,
                    1.0);
}

}  // namespace simvis
