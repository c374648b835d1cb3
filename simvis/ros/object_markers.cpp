#include "simvis/ros/object_markers.h"

#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "engine/draw/oriented_box.h"
#include "exchange/messages/from_pose.h"

namespace simvis {
namespace {

// What lies inside the box stays visible.
constexpr ros::ColorRGBA kBoxColor{.r = 0.2F, .g = 0.6F, .b = 1, .a = 0.25F};

struct Corners {
  glm::dvec3 low_m{std::numeric_limits<double>::infinity()}, high_m{-std::numeric_limits<double>::infinity()};
};

// In the object's frame. Empty: none of its surfaces is visible, or one has no end.
std::optional<Corners> corners_of(const SceneObject& object, const DrawList& list) {
  Corners corners;
  bool is_visible = false;
  for (const ObjectSurface& surface : object.surfaces) {
    const DrawItem& item = list.items[surface.item];
    if (!item.visible) continue;
    is_visible = true;
    const Mesh& mesh = *list.meshes[item.mesh];
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 at((corner & 1) != 0 ? mesh.bounds_max.x : mesh.bounds_min.x,
                          (corner & 2) != 0 ? mesh.bounds_max.y : mesh.bounds_min.y,
                          (corner & 4) != 0 ? mesh.bounds_max.z : mesh.bounds_min.z);
      const glm::dvec3 in_frame(surface.frame_from_mesh * glm::dvec4(at, 1));
      corners.low_m = glm::min(corners.low_m, in_frame);
      corners.high_m = glm::max(corners.high_m, in_frame);
    }
  }
  if (!is_visible) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(corners.low_m[axis]) || !std::isfinite(corners.high_m[axis])) return std::nullopt;
  }
  return corners;
}

}  // namespace

ros::MarkerArray object_markers(std::span<const SceneObject> objects, const DrawList& list, std::string_view world,
                                std::int64_t time_ns) {
  ros::MarkerArray array;
  ros::Marker clear;
  clear.header = ros::header_of(time_ns, world);
  clear.action = ros::Marker::kDeleteAll;
  array.markers.push_back(std::move(clear));
  for (const SceneObject& object : objects) {
    const std::optional<Corners> corners = corners_of(object, list);
    if (!corners) continue;
    const OrientedBox box = oriented_box(corners->low_m, corners->high_m, list.world_from_node[object.transform]);
    ros::Marker marker;
    marker.header = ros::header_of(time_ns, world);
    marker.ns = object.path;
    marker.id = std::bit_cast<std::int32_t>(object.instance);
    marker.type = ros::Marker::kCube;
    marker.action = ros::Marker::kAdd;
    marker.pose.position = {box.centre_m.x, box.centre_m.y, box.centre_m.z};
    marker.pose.orientation = {box.orientation.x, box.orientation.y, box.orientation.z, box.orientation.w};
    marker.scale = {box.size_m.x, box.size_m.y, box.size_m.z};
    marker.color = kBoxColor;
    marker.text = std::string(to_string(object.kind)) + (object.label.empty() ? "" : " of class " + object.label);
    array.markers.push_back(std::move(marker));
  }
  return array;
}

}  // namespace simvis
