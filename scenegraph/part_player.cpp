#include "scenegraph/part_player.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"

namespace simvis {
namespace {

template <class T>
std::shared_ptr<T> clone(const NodeMap& clone_of, const std::shared_ptr<const T>& node) {
  return node == nullptr ? nullptr : std::static_pointer_cast<T>(clone_of.at(node.get()));
}

}  // namespace

PartPlayer::PartPlayer(std::shared_ptr<const PartAnimations> animations, std::size_t clip, const NodeMap& clone_of)
    : animations_(std::move(animations)), clip_(&animations_->clips[clip]) {
  for (const AnimatedNode& node : animations_->nodes) {
    poses_.push_back(node.rest);
    weights_.push_back(node.weights_at_rest);
    parent_from_node_.push_back(node.parent_from_node_at_rest);
  }
  root_from_node_.resize(poses_.size());
  joint_matrices_.resize(animations_->skins.size());
  std::size_t widest = 0;
  for (const AnimationSampler& sampler : clip_->samplers) widest = std::max(widest, sampler.width);
  sampled_.resize(widest);
  find_movers(clone_of);
  find_deformed(clone_of);
}

void PartPlayer::find_movers(const NodeMap& clone_of) {
  std::vector<bool> moved(animations_->nodes.size(), false);
  for (const AnimationChannel& channel : clip_->channels) {
    if (channel.property == AnimatedProperty::weights || moved[channel.node]) continue;
    moved[channel.node] = true;
    movers_.push_back({channel.node, clone<Transform>(clone_of, animations_->nodes[channel.node].transform)});
  }
}

void PartPlayer::find_deformed(const NodeMap& clone_of) {
  const std::vector<bool> moved = nodes_moved_by(*animations_, *clip_);
  for (const AnimatedShape& shape : animations_->shapes) {
    const auto is_its_weights = [&](const AnimationChannel& channel) {
      return channel.property == AnimatedProperty::weights && static_cast<int>(channel.node) == shape.node;
    };
    bool is_bent = false;
    if (shape.skin >= 0) {
      const AnimatedSkin& skin = animations_->skins[static_cast<std::size_t>(shape.skin)];
      is_bent = std::ranges::any_of(skin.joints, [&](std::size_t joint) { return moved[joint]; });
    }
    if (!is_bent && std::ranges::none_of(clip_->channels, is_its_weights)) continue;
    has_skins_ = has_skins_ || shape.skin >= 0;
    deformed_.push_back({&shape, clone<Shape>(clone_of, shape.shape), {}, {}});
  }
}

std::vector<const Node*> PartPlayer::driven() const {
  std::vector<const Node*> nodes;
  for (const Mover& mover : movers_) {
    if (mover.transform != nullptr) nodes.push_back(mover.transform.get());
  }
  for (const Deformed& deformed : deformed_) nodes.push_back(deformed.shape.get());
  return nodes;
}

void PartPlayer::show(double time_s) {
  sample_channels(time_s);
  for (const Mover& mover : movers_) {
    parent_from_node_[mover.node] = matrix_of(poses_[mover.node]);
    if (mover.transform != nullptr) mover.transform->set_matrix(parent_from_node_[mover.node]);
  }
  if (has_skins_) update_joints();
  for (Deformed& deformed : deformed_) deform_shape(deformed);
}

void PartPlayer::show_rest() {
  for (const Mover& mover : movers_) {
    if (mover.transform == nullptr) continue;
    mover.transform->set_matrix(animations_->nodes[mover.node].parent_from_node_at_rest);
  }
  for (Deformed& deformed : deformed_) {
    deformed.shape->restore_mesh(deformed.source->shape->mesh());
    deformed.weights.clear();
    deformed.joint_matrices.clear();
  }
}

void PartPlayer::sample_channels(double time_s) {
  for (const AnimationChannel& channel : clip_->channels) {
    const AnimationSampler& sampler = clip_->samplers[channel.sampler];
    const std::span<double> value(sampled_.data(), sampler.width);
    sample_animation(sampler, channel.property, time_s, value);
    LocalPose& pose = poses_[channel.node];
    switch (channel.property) {
      case AnimatedProperty::translation:
        pose.translation = {value[0], value[1], value[2]};
        break;
      case AnimatedProperty::rotation:
        pose.rotation = {value[0], value[1], value[2], value[3]};
        break;
      case AnimatedProperty::scale:
        pose.scale = {value[0], value[1], value[2]};
        break;
      case AnimatedProperty::weights:
        weights_[channel.node].assign(value.begin(), value.end());
        break;
    }
  }
}

// Parents come before their children, so one pass is enough.
void PartPlayer::update_joints() {
  for (std::size_t i = 0; i < root_from_node_.size(); ++i) {
    const int parent = animations_->nodes[i].parent;
    root_from_node_[i] =
        parent < 0 ? parent_from_node_[i] : root_from_node_[static_cast<std::size_t>(parent)] * parent_from_node_[i];
  }
  for (std::size_t s = 0; s < joint_matrices_.size(); ++s) {
    const AnimatedSkin& skin = animations_->skins[s];
    joint_matrices_[s].resize(skin.joints.size());
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      joint_matrices_[s][j] = root_from_node_[skin.joints[j]] * skin.joint_from_mesh[j];
    }
  }
}

void PartPlayer::deform_shape(Deformed& deformed) {
  static const std::vector<glm::dmat4> no_joints;
  const AnimatedShape& source = *deformed.source;
  const std::vector<double>& weights =
      source.node < 0 ? source.weights_at_rest : weights_[static_cast<std::size_t>(source.node)];
  const std::vector<glm::dmat4>& joints =
      source.skin < 0 ? no_joints : joint_matrices_[static_cast<std::size_t>(source.skin)];
  if (weights == deformed.weights && joints == deformed.joint_matrices) return;
  std::optional<Mesh> mesh = deform(*source.mesh, weights, joints);
  SIMVIS_ASSERT(mesh.has_value());
  mesh->short_lived = true;
  deformed.shape->set_mesh(std::make_shared<const Mesh>(std::move(*mesh)));
  deformed.weights = weights;
  deformed.joint_matrices = joints;
}

}  // namespace simvis
