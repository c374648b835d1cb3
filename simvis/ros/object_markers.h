// The objects of a scene as markers of ROS, which Foxglove and RViz list by their namespaces: parts, models and links
// with their boxes.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include <simvis/draw_list.h>
#include <simvis/object_tree.h>
#include "exchange/messages/types/marker_types.h"

namespace simvis {

/// One cube for each object that has visible surfaces with an end: its namespace is the object's path, its id the
/// object's instance, its text the kind and the class, its place the box of the surfaces in the object's frame, as of
/// `list`. Before them, a marker deletes those of earlier messages.
ros::MarkerArray object_markers(std::span<const SceneObject> objects, const DrawList& list, std::string_view world,
                                std::int64_t time_ns);

}  // namespace simvis
