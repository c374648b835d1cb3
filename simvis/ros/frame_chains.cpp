#include "simvis/ros/frame_chains.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "scenegraph/graph_walk.h"

namespace simvis {
namespace {

class ChainWalk {
 public:
  explicit ChainWalk(const std::set<const Node*>& wanted) : wanted_(wanted) {}

  std::map<const Node*, FrameChain> take(const Group& root) {
    walk_graph(root, {.visit = [this](const Node& node, const WalkState&) { visit(node); },
                      .leave = [this](const Group& group) { leave(group); }});
    return std::move(found_);
  }

 private:
  static bool is_group(const Node& node) {
    return node.kind() == NodeKind::group || node.kind() == NodeKind::separator || node.kind() == NodeKind::switch_ ||
           node.kind() == NodeKind::visual;
  }

  void visit(const Node& node) {
    if (wanted_.contains(&node)) found_[&node] = {transforms_, groups_};
    if (node.kind() == NodeKind::transform) transforms_.push_back(&node);
    if (!is_group(node)) return;
    groups_.push_back(&node);
    begins_.push_back(transforms_.size());
  }

  // Transforms in a separator end with it; those in another group go on, as in the flattener.
  void leave(const Group& group) {
    const std::size_t before = begins_.back();
    begins_.pop_back();
    groups_.pop_back();
    if (group.kind() == NodeKind::separator || group.kind() == NodeKind::visual) transforms_.resize(before);
  }

  const std::set<const Node*>& wanted_;
  std::map<const Node*, FrameChain> found_;
  std::vector<const Node*> transforms_, groups_;
  std::vector<std::size_t> begins_;  // of the transforms in each open group
};

}  // namespace

FrameChains find_chains(const Group& root, const std::set<const Node*>& wanted) { return ChainWalk(wanted).take(root); }

bool stands_between(const std::set<const Node*>& movers, const FrameChain& a, const FrameChain& b) {
  const auto [own_a, own_b] = std::ranges::mismatch(a.transforms, b.transforms);
  const auto is_mover = [&](const Node* node) { return movers.contains(node); };
  return std::any_of(own_a, a.transforms.end(), is_mover) || std::any_of(own_b, b.transforms.end(), is_mover);
}

}  // namespace simvis
