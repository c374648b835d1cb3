// The contacts of two bodies as Bullet's solver reads them: in manifolds of at most four points.
#pragma once

#include <btBulletCollisionCommon.h>

#include <optional>
#include <span>
#include <vector>

#include <simvis/state_archive.h>
#include "elements/dynamics/bullet/convex_contact.h"

namespace simvis {

/// Surfaces that move along themselves, or have rollers, at a point of a manifold; world frame.
struct MovingSurface {
  btVector3 slide{0, 0, 0};        ///< as ContactPoint::slide
  btVector3 roller_axis{0, 0, 0};  ///< along the surface, of unit length; 0: there are no rollers
};
/// Empty if neither surface moves.
std::optional<MovingSurface> moving_surface(const btManifoldPoint& point);

class ContactManifolds {
 public:
  ContactManifolds(btDispatcher& dispatcher, const btCollisionObject& a, const btCollisionObject& b)
      : dispatcher_(dispatcher), a_(a), b_(b) {}
  ~ContactManifolds();
  ContactManifolds(const ContactManifolds&) = delete;
  ContactManifolds& operator=(const ContactManifolds&) = delete;

  /// Makes these the contacts of the pair. Of those with one normal and surface at most four remain, which hold the
  /// bodies as all do. The impulse of an old contact goes over to the nearest new one.
  void replace(std::span<const ContactPoint> contacts);
  void add_to(btManifoldArray& manifolds) const;
  /// Writes the contacts, or replaces them.
  void archive(StateArchive& state);

 private:
  void add(std::size_t manifold, const ContactPoint& contact);

  btDispatcher& dispatcher_;
  const btCollisionObject &a_, &b_;
  std::vector<btPersistentManifold*> manifolds_;
};

}  // namespace simvis
