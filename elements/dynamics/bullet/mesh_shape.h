// A mesh whose triangles have their neighbours.
#pragma once

#include <btBulletCollisionCommon.h>

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace simvis {

class MeshShape : public btBvhTriangleMeshShape {
 public:
  /// Three indices into `points` for each triangle, as in `array`, which the shape refers to.
  MeshShape(btStridingMeshInterface* array, std::span<const btVector3> points, std::span<const int> indices);

  struct Contact {
    int triangle = 0;
    std::array<btVector3, 3> corners;
    btVector3 on_mesh, normal;  ///< the nearest point of the triangle; from there to the body, unit
    btVector3 body_center;
    bool overlaps = false;
  };
  /// The normal that the neighbours of a triangle leave to a contact with it, in the frame of the mesh. Between two
  /// triangles of a plane or a hollow, only their own normals are right; over a ridge, those between both. None: the
  /// neighbour has the contact.
  std::optional<btVector3> allowed_normal(const Contact& contact) const;

 private:
  // For each edge: from the edge into the neighbour's plane, unit, perpendicular to the edge; zero at a border.
  std::vector<std::array<btVector3, 3>> into_neighbours_;
};

}  // namespace simvis
