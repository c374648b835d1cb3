// Whether two graphs hold the same, so that one can stand for both.
#pragma once

#include <simvis/node.h>

namespace simvis {

/// Same nodes in the same order with the same names (but for the topmost's, often the file's), matrices, lights and
/// sharing; meshes and materials by identity, so they should come from one ContentPool.
bool same_graph(const NodePtr& a, const NodePtr& b);

}  // namespace simvis
