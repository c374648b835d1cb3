// A tree over the triangles of one mesh.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/embree_handles.h"
#include "engine/mesh.h"

namespace simvis {

/// Boxes of triangles in the mesh's unit frame: (p - centre) / radius, so that all lies in the unit ball.
class MeshTree {
 public:
  /// Meshes of so few triangles have no tree: testing them all costs less than walking one.
  static constexpr std::uint32_t kFew = 12;

  /// `on_triangle` is called with the rays whose way leads through a triangle's box.
  MeshTree(RTCDevice device, std::shared_ptr<const Mesh> mesh, RTCIntersectFunctionN on_triangle);

  const std::shared_ptr<const Mesh>& mesh() const { return mesh_; }
  std::uint32_t triangles() const { return triangles_; }
  const glm::dvec3& centre() const { return centre_; }  ///< of the mesh's box
  double radius() const { return radius_; }             ///< half the box's diagonal
  glm::dvec3 half_size() const { return half_size_; }   ///< of the box, in radii
  RTCScene scene() const { return scene_.get(); }       ///< null for few triangles

 private:
  static void bounds(const RTCBoundsFunctionArguments* arguments);

  std::shared_ptr<const Mesh> mesh_;
  std::uint32_t triangles_;
  glm::dvec3 centre_, half_size_;
  double radius_;
  EmbreeScene scene_;
};

}  // namespace simvis
