// Puts one part into the poses of one of its animations.
#pragma once

#include <memory>
#include <vector>

#include "scenegraph/clone_graph.h"
#include "scenegraph/part_animation.h"

namespace simvis {

/// Every pose is computed from the pose at rest and the time alone: no error grows from one to the next. What a pose
/// leaves as it was is not touched.
class PartPlayer {
 public:
  /// `clone_of` leads from the nodes of the part's content to those that are moved.
  PartPlayer(std::shared_ptr<const PartAnimations> animations, std::size_t clip, const NodeMap& clone_of);

  double duration_s() const { return clip_->duration_s; }

  /// The transforms and shapes that the clip changes. Players of one part that have none in common do not disturb each
  /// other.
  std::vector<const Node*> driven() const;

  /// Poses the part as at this time of the clip: before its first key as there, after its last key as there.
  void show(double time_s);

  /// Poses it as its file does without a clip.
  void show_rest();

 private:
  // A node that the clip moves.
  struct Mover {
    std::size_t node;
    std::shared_ptr<Transform> transform;  // null: not in the graph
  };
  // A shape that the clip deforms, and what its mesh was last made from.
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
  std::vector<double> sampled_;                                // room for one value
  std::vector<LocalPose> poses_;                               // by node; of movers
  std::vector<std::vector<double>> weights_;                   // by node
  std::vector<glm::dmat4> parent_from_node_, root_from_node_;  // by node
  std::vector<std::vector<glm::dmat4>> joint_matrices_;        // by skin
};

}  // namespace simvis
