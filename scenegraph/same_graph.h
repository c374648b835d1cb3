// Compares two graphs, so that one can replace the other.
#pragma once

#include <simvis/node.h>

namespace simvis {

/// Returns whether both graphs have the same nodes in the same order, with the same names, matrices, lights and
/// sharing. Meshes and materials are compared by identity, so they should come from one ContentPool.
bool same_graph(const NodePtr& a, const NodePtr& b);

}  // namespace simvis
