// Which contacts act before the surfaces meet.
//
// Bullet brakes a body that is about to touch, so that it comes to rest at the surface. A bounce must start from the
// whole speed instead: its contact acts only once the bodies overlap. Which of the two it is follows from the pair that
// touches and its speed, not from either body.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletDynamicsCommon.h>

namespace simvis {

/// Sets of each manifold up to which distance its contacts act in this step.
inline void choose_processing_distances(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) {
  const auto velocity = [](const btCollisionObject& object, const btVector3& at) {
    const btRigidBody* const body = btRigidBody::upcast(&object);
    return body == nullptr ? btVector3(0, 0, 0)
                           : body->getVelocityInLocalPoint(at - object.getWorldTransform().getOrigin());
  };
  for (int i = 0; i < count; ++i) {
    btPersistentManifold& manifold = *manifolds[i];
    const btCollisionObject &a = *manifold.getBody0(), &b = *manifold.getBody1();
    // Bullet gives the speed of a link to no one cheaply: with links, all pairs that may bounce count as fast.
    const bool has_link =
        btMultiBodyLinkCollider::upcast(&a) != nullptr || btMultiBodyLinkCollider::upcast(&b) != nullptr;
    bool bounces = false;
    for (int p = 0; p < manifold.getNumContacts(); ++p) {
      const btManifoldPoint& point = manifold.getContactPoint(p);
      if (point.m_combinedRestitution <= 0) continue;
      const btVector3 approach = velocity(b, point.getPositionWorldOnB()) - velocity(a, point.getPositionWorldOnA());
      bounces |= has_link || approach.dot(point.m_normalWorldOnB) >= info.m_restitutionVelocityThreshold;
    }
    manifold.setContactProcessingThreshold(bounces ? 0 : BT_LARGE_FLOAT);
  }
}

/// A solver of Bullet that does so.
template <typename Solver>
class BounceSolver : public Solver {
 protected:
  void convertContacts(btPersistentManifold** manifolds, int count, const btContactSolverInfo& info) override {
    choose_processing_distances(manifolds, count, info);
    Solver::convertContacts(manifolds, count, info);
  }
};

}  // namespace simvis
