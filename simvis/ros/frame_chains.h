// Where nodes stand in the graph: the transforms in front of them, and the insertion points around them.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <simvis/node.h>

namespace simvis {

/// The place of one node.
struct FrameChain {
  std::vector<const Node*> transforms;  ///< that apply to it, the outermost first
  std::vector<const Node*> groups;      ///< that it is in, the outermost first
};

using FrameChains = std::map<const Node*, FrameChain>;

/// The places of those of `wanted` that are not below a switch that is off; of a node that occurs several times, the
/// last one, as Scene::world_from_point() has it.
FrameChains find_chains(const Group& root, const std::set<const Node*>& wanted);

/// Whether one of `movers` applies to one of the two nodes and not to the other.
bool stands_between(const std::set<const Node*>& movers, const FrameChain& a, const FrameChain& b);

}  // namespace simvis
