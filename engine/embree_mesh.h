// A tree over the triangles of one mesh.
#pragma once

#include <memory>

#include "engine/embree_handles.h"

namespace simvis {

/// Boxes of triangles in the mesh's unit frame.
class EmbreeMesh : public RayMesh {
 public:
  /// `on_triangle` is called with the rays whose way leads through a triangle's box.
  EmbreeMesh(RTCDevice device, std::shared_ptr<const Mesh> mesh, RTCIntersectFunctionN on_triangle);

  RTCScene scene() const { return scene_.get(); }  ///< null for few triangles

 private:
  static void bounds(const RTCBoundsFunctionArguments* arguments);

  EmbreeScene scene_;
};

}  // namespace simvis
