// Copies of graphs, for those who must change one occurrence of a part and not the others.
#pragma once

#include <unordered_map>

#include <simvis/node.h>

namespace simvis {

/// Copies every node below `root`, and `root`; what the nodes hold (meshes, materials, textures) stays shared. A node
/// that stands in several places is copied once. `clone_of` gets an entry for each node.
NodePtr clone_graph(const NodePtr& root, NodeMap& clone_of);

/// Every node of a graph once, parents before what they alone hold.
std::vector<NodePtr> nodes_of(const NodePtr& root);

}  // namespace simvis
