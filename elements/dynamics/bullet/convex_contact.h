// Where two convex shapes touch, or will touch within a step.
#pragma once

#include <btBulletCollisionCommon.h>

#include <optional>
#include <vector>

#include "elements/dynamics/bullet/bullet_shape.h"
#include "elements/dynamics/bullet/mesh_shape.h"
#include "elements/dynamics/world/world.h"

namespace simvis {

/// A contact of two surfaces a and b, in the world.
struct ContactPoint {
  btVector3 on_a, on_b;
  btVector3 normal;     ///< from b towards a, unit
  double distance = 0;  ///< along the normal; below 0 they overlap
  double friction = 0, restitution = 0;
  btVector3 slide{0, 0, 0};        ///< by which the surface of a moves along itself, relative to that of b; m/s
  btVector3 roller_axis{0, 0, 0};  ///< friction acts along it only; 0: along all directions
};

/// A piece of a body's surface.
struct ContactPiece {
  const btCollisionShape& shape;
  btTransform world_from_shape;
  const BulletSurface& surface;
  int part = 0;  ///< of the body
};

/// A triangle of a mesh that collides.
struct MeshTriangle {
  const MeshShape& mesh;
  int index;
};

/// How far two bodies may come towards each other in a step.
struct ContactReach {
  btVector3 motion{0, 0, 0};  ///< of a relative to b, of their centres
  double turn = 0;            ///< of all other points relative to that, at most
  double rest = 0;            ///< contacts are kept at this distance though nothing moves

  double length() const { return motion.length() + turn + rest; }
};

/// Adds the contacts of two convex shapes. With `triangle`, b is that triangle of a mesh.
void add_convex_contacts(const ContactPiece& a, const ContactPiece& b, const ContactReach& reach,
                         const std::optional<MeshTriangle>& triangle, std::vector<ContactPoint>& contacts);

/// Adds the contacts of a convex shape with an infinite plane, solid below.
void add_plane_contacts(const ContactPiece& convex, const ContactPiece& plane, const ContactReach& reach,
                        std::vector<ContactPoint>& contacts);

}  // namespace simvis
