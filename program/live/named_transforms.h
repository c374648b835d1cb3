// Which entry of the draw list's transforms moves what has a name.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "simvis/scene_builder.h"

namespace simvis::live {

/// Numbers are indices into DrawList::world_from_node.
struct NamedTransforms {
  std::map<std::string, std::uint32_t> points, elements;  ///< insertion points; transforms of pose elements
  std::vector<std::optional<std::uint32_t>> sensors;      ///< of the mounts; empty: below a switch that is off
};

/// Walks the graph in the order in which the flattener makes the draw list of sensors. The scene is as it was when the
/// list was made: right after a step.
NamedTransforms named_transforms(const BuiltScene& built);

}  // namespace simvis::live
