// Visits the nodes of a scene graph in the order of traversal, with the state that applies to each.
#pragma once

#include <functional>
#include <glm/glm.hpp>

#include <simvis/node.h>
#include "engine/base/program_api.h"

namespace simvis {

/// The state at a node.
struct WalkState {
  glm::dmat4 world_from_node{1.0};
  const MaterialNode* material = nullptr;  ///< null: the default material
  bool visible = true;
};

struct GraphVisitor {
  std::function<void(const Node&, const WalkState&)>
      visit;                                          ///< each occurrence of a node; groups before their children
  std::function<void(const Group&)> leave = nullptr;  ///< each group, after its children; may be empty
};

/// Walks as people see the graph: below VisualSeparators too, and below switches as they stand. The graph has no
/// cycles.
SIMVIS_PROGRAM_API void walk_graph(const Group& root, const GraphVisitor& visitor);

}  // namespace simvis
