// The items of a draw list that rays can meet, and a tree over their boxes.
#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "engine/draw_list.h"
#include "engine/embree_mesh.h"
#include "engine/ray_caster.h"
#include "engine/ray_triangle.h"

namespace simvis {

/// An item in the world.
struct PlacedItem {
  std::uint32_t item = 0;  ///< of the draw list
  const MeshTree* tree = nullptr;
  glm::dmat4 world_from_mesh{1.0};
  RTCBounds box{};
};

/// An item as one sensor sees it.
struct SeenItem {
  std::uint64_t cast = 0;  ///< the cast for which this was made
  MeshPlacement placement;
  glm::dvec3 centre{0};              ///< of the mesh's box, sensor frame
  glm::dmat3 unit_from_sensor{1.0};  ///< for vectors: to the mesh's unit frame. Not if `one_by_one`
  double units_per_m = 1;            ///< about how long a vector of 1 m is there
  bool one_by_one = false;           ///< triangles are tested without a tree
  double corner_error_m = 0;         ///< by how much rounding may have displaced a corner
};

/// World frame, its origin moved to near the sensors: at most kReach_m away from whoever casts.
class ItemTree {
 public:
  static constexpr double kReach_m = 1000;

  ItemTree(RTCIntersectFunctionN on_item, RTCIntersectFunctionN on_triangle);

  /// Brings everything up to date with the list, for a sensor at this place.
  void update(const DrawList& list, const glm::dvec3& world_sensor);

  RTCScene scene() const { return scene_.get(); }
  const glm::dvec3& origin() const { return origin_; }
  const std::vector<PlacedItem>& items() const { return items_; }
  const RayCounters& counters() const { return counters_; }

 private:
  static void bounds(const RTCBoundsFunctionArguments* arguments);
  bool take_structure(const DrawList& list);
  bool place(const DrawList& list, bool everything);
  void build();

  EmbreeDevice device_;
  RTCIntersectFunctionN on_item_, on_triangle_;
  std::unordered_map<const Mesh*, std::unique_ptr<MeshTree>> trees_;
  std::vector<DrawItem> list_items_;
  std::vector<std::shared_ptr<const Mesh>> list_meshes_;
  std::vector<PlacedItem> items_;
  bool anchored_ = false;
  glm::dvec3 origin_{0};
  EmbreeGeometry geometry_;
  EmbreeScene scene_;
  RayCounters counters_;
};

/// `world_from_sensor` is rigid.
SeenItem see(const PlacedItem& item, const glm::dmat4& world_from_sensor);

}  // namespace simvis
