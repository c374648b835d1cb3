// Copies of scene graphs, for changes to one occurrence of a part that must not show in the others.
#pragma once

#include <vector>

#include <simvis/node.h>

namespace simvis {

/// Copies `root` and every node below it. Meshes, materials and textures that the nodes hold stay shared. A node that
/// has several parents is copied once. `clone_of` gets an entry for each node. Observers are not copied.
NodePtr clone_graph(const NodePtr& root, NodeMap& clone_of);

/// Every node of a graph once, breadth first from `root`: a node comes after at least one of its parents.
std::vector<NodePtr> nodes_of(const NodePtr& root);

}  // namespace simvis
