// The objects in the file of a part, as its insertion points say.
#pragma once

#include <cstddef>
#include <vector>

#include <simvis/node.h>

namespace simvis {

/// An object of a file.
struct PartObject {
  Group* group = nullptr;           ///< that has the point
  InsertionPoint* point = nullptr;  ///< says the object's name and kind
  std::size_t parent = 0;           ///< 0: the part; otherwise 1 more than the object's place in part_objects()
};

/// The objects of a part's own graph, into which nothing has been inserted, in the order of traversal. Models and links
/// belong to the model around them, frames to what stands around them.
std::vector<PartObject> part_objects(const NodePtr& root);

}  // namespace simvis
