// Bullet's collision shapes.
#pragma once

#include <btBulletCollisionCommon.h>

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "elements/dynamics/world/world.h"

namespace simvis {

/// The surface of a piece. The vectors are those of SurfaceMotion, in the frame of the piece; 0: none.
struct BulletSurface : SurfaceProperties {
  btVector3 belt_m_s{0, 0, 0}, roller_axis{0, 0, 0};
  bool moves() const { return !belt_m_s.isZero() || !roller_axis.isZero(); }
};

/// A collision shape with all that it refers to. The user pointer of a piece points to its BulletSurface, its user
/// index is the number of its part.
class BulletShape {
 public:
  /// The shapes of one body, in a frame in which the body's frame stands at `frame_from_body`; those without a surface
  /// of their own have `surface`. None: a shape without surface.
  BulletShape(std::span<const CollisionShape> shapes, const SurfaceProperties& surface,
              const btTransform& frame_from_body);
  btCollisionShape* get() const { return whole_; }
  /// Sets the motion of all pieces of a part.
  void move_surface(int part, const SurfaceMotion& motion);
  const CollisionMask& mask() const { return mask_; }  ///< the bits that any of the shapes has

 private:
  btCollisionShape* add(const CollisionShape& shape);
  btCollisionShape* add_mesh(const CollisionShape& shape);
  template <typename Made>
  Made* keep(std::unique_ptr<Made> made);

  // Later ones refer to earlier ones.
  struct MeshData {
    std::vector<btVector3> points;
    std::vector<int> indices;
  };
  std::vector<std::unique_ptr<MeshData>> meshes_;
  std::vector<std::unique_ptr<btStridingMeshInterface>> arrays_;
  struct Piece {
    int part;
    btMatrix3x3 piece_from_body;  // turns directions
    std::unique_ptr<BulletSurface> surface;
  };
  std::vector<Piece> pieces_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  btCollisionShape* whole_ = nullptr;
  CollisionMask mask_{.category = 0, .collides = 0};
};

std::optional<CollisionShape> bullet_convex_hull(std::span<const glm::dvec3> points);

}  // namespace simvis
