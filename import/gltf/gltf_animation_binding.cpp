// Converts a glTF file's animations to a part's animations and keeps only the nodes that they need.
#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "import/gltf/animation_overflow.h"
#include "import/gltf/gltf_animations.h"

namespace simvis {
namespace {

class AnimationBinder {
 public:
  AnimationBinder(const GltfDocument& document, const GltfHierarchy& hierarchy, GltfMotion&& motion,
                  GltfBindings&& bindings)
      : document_(document), hierarchy_(hierarchy), motion_(std::move(motion)), bindings_(std::move(bindings)) {}

  std::shared_ptr<const PartAnimations> bind() {
    find_wanted();
    for (const int node : hierarchy_.order) {
      if (wanted_[static_cast<std::size_t>(node)]) add_node(static_cast<std::size_t>(node));
    }
    for (AnimatedShape& shape : bindings_.shapes) {
      if (shape.node >= 0) shape.node = number_of(shape.node);
      if (shape.skin >= 0) shape.skin = add_skin(shape.skin);
      result_.shapes.push_back(std::move(shape));
    }
    for (AnimationClip& clip : motion_.clips) {
      for (AnimationChannel& channel : clip.channels) channel.node = numbers_[channel.node];
      result_.clips.push_back(std::move(clip));
    }
    const std::string overflow = animation_overflow(result_);
    if (!overflow.empty())
      document_.fail("has animations that can move " + overflow + " to where float32 is not finite");
    return std::make_shared<const PartAnimations>(std::move(result_));
  }

 private:
  int number_of(int node) const { return static_cast<int>(numbers_[static_cast<std::size_t>(node)]); }

  // Finds the moved nodes, the joints of deformed skins, and all ancestors of these nodes.
  void find_wanted() {
    wanted_ = motion_.is_moved;
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      if (motion_.moving_weights[i] > 0) wanted_[i] = true;
    }
    for (const AnimatedShape& shape : bindings_.shapes) {
      if (shape.skin < 0) continue;
      for (const int joint : document_.model.skins[static_cast<std::size_t>(shape.skin)].joints) {
        wanted_[static_cast<std::size_t>(joint)] = true;
      }
    }
    for (auto node = hierarchy_.order.rbegin(); node != hierarchy_.order.rend(); ++node) {
      const int parent = hierarchy_.parents[static_cast<std::size_t>(*node)];
      if (parent >= 0 && wanted_[static_cast<std::size_t>(*node)]) wanted_[static_cast<std::size_t>(parent)] = true;
    }
    numbers_.resize(wanted_.size());
  }

  void add_node(std::size_t index) {
    numbers_[index] = result_.nodes.size();
    AnimatedNode& node = result_.nodes.emplace_back();
    const int parent = hierarchy_.parents[index];
    if (parent >= 0) node.parent = number_of(parent);
    node.parent_from_node_at_rest = hierarchy_.parent_from_node[index];
    if (motion_.is_moved[index]) {
      node.rest = read_local_pose(document_, index);
      node.transform = bindings_.transforms[index];
    }
    if (motion_.moving_weights[index] > 0) {
      node.weights_at_rest = rest_weights(document_, static_cast<int>(index));
      node.weights_at_rest.resize(motion_.moving_weights[index], 0.0);
    }
  }

  int add_skin(int skin) {
    const auto [known, is_new] = skins_.try_emplace(skin, static_cast<int>(result_.skins.size()));
    if (!is_new) return known->second;
    AnimatedSkin& added = result_.skins.emplace_back();
    added.joint_from_mesh = read_inverse_bind_matrices(document_, skin);
    for (const int joint : document_.model.skins[static_cast<std::size_t>(skin)].joints) {
      added.joints.push_back(numbers_[static_cast<std::size_t>(joint)]);
    }
    return known->second;
  }

  const GltfDocument& document_;
  const GltfHierarchy& hierarchy_;
  GltfMotion motion_;
  GltfBindings bindings_;
  PartAnimations result_;
  std::vector<bool> wanted_;          // by node of the file
  std::vector<std::size_t> numbers_;  // node of the result, by node of the file
  std::map<int, int> skins_;          // skin of the result, by skin of the file
};

}  // namespace

std::shared_ptr<const PartAnimations> bind_animations(const GltfDocument& document, const GltfHierarchy& hierarchy,
                                                      GltfMotion&& motion, GltfBindings&& bindings) {
  if (motion.clips.empty()) return nullptr;
  return AnimationBinder(document, hierarchy, std::move(motion), std::move(bindings)).bind();
}

}  // namespace simvis
