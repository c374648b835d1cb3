// Sets one part to the poses of one of its animations.
#pragma once

#include <memory>
#include <vector>

#include "scenegraph/clone_graph.h"
#include "scenegraph/part_animation.h"

namespace simvis {

/// Every pose is computed only from the rest pose and the time, so errors do not accumulate. Nodes that a pose does not
/// change are not written.
class PartPlayer {
 public:
  /// `clone_of` maps the nodes of the part's content to the nodes that are moved.
  PartPlayer(std::shared_ptr<const PartAnimations> animations, std::size_t clip, const NodeMap& clone_of);

  double duration_s() const { return clip_->duration_s; }

  /// Returns the transforms and shapes that the clip changes. Players of one part do not affect each other if they have
  /// none in common.
  std::vector<const Node*> driven() const;

  /// Sets the part to the pose at this time of the clip. Before the first key it is the pose of the first key, and
  /// after the last key the pose of the last key.
  void show(double time_s);

  /// Sets the part to the rest pose of its file.
  void show_rest();

 private:
  // A node that the clip moves.
  struct Mover {
    std::size_t node;
    std::shared_ptr<Transform> transform;  // null: not in the graph
  };
  // A shape that the clip deforms, and the weights and joint matrices of its present mesh.
  struct Deformed {
    const AnimatedShape* source;
    std::shared_ptr<Shape> shape;
    std::vector<double> weights;
    std::vector<glm::dmat4> joint_matrices;
  };
  void find_movers(const NodeMap& clone_of);
  void find_deformed(const NodeMap& clone_of);
  void sample_channels(double time_s);
  void update_joints();
  void deform_shape(Deformed& deformed);

  std::shared_ptr<const PartAnimations> animations_;
  const AnimationClip* clip_;
  std::vector<Mover> movers_;
  std::vector<Deformed> deformed_;
  bool has_skins_ = false;
  std::vector<double> sampled_;                                // scratch space for one value
  std::vector<LocalPose> poses_;                               // by node; used for movers
  std::vector<std::vector<double>> weights_;                   // by node
  std::vector<glm::dmat4> parent_from_node_, root_from_node_;  // by node
  std::vector<std::vector<glm::dmat4>> joint_matrices_;        // by skin
};

}  // namespace simvis
