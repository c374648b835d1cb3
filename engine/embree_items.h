// A tree over the boxes of what rays can meet.
#pragma once

#include "engine/embree_mesh.h"

namespace simvis {

class EmbreeItems {
 public:
  EmbreeItems(RTCIntersectFunctionN on_item, RTCIntersectFunctionN on_triangle);

  /// Brings everything up to date with the list, for a sensor at this place.
  void update(const DrawList& list, const glm::dvec3& world_sensor);

  RTCScene scene() const { return scene_.get(); }
  const RayItems& items() const { return items_; }

 private:
  static void bounds(const RTCBoundsFunctionArguments* arguments);
  void build();

  EmbreeDevice device_;
  RTCIntersectFunctionN on_item_;
  RayItems items_;
  EmbreeGeometry geometry_;
  EmbreeScene scene_;
  bool built_ = false;
};

}  // namespace simvis
