// The animations that a part's file brings along, whatever its format: clips of keys over time, and the nodes and
// shapes of the part's graph that they move.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <simvis/node.h>
#include "scenegraph/mesh_deformation.h"

namespace simvis {

/// Where a node stands in its parent's frame: scaled first, then turned, then moved.
struct LocalPose {
  glm::dvec3 translation{0};
  glm::dvec4 rotation{0, 0, 0, 1};  ///< a unit quaternion x, y, z, w
  glm::dvec3 scale{1};
};

/// parent_from_node.
glm::dmat4 matrix_of(const LocalPose& pose);

enum class AnimationInterpolation : std::uint8_t { step, linear, cubic_spline };
enum class AnimatedProperty : std::uint8_t { translation, rotation, scale, weights };

/// Values at points in time, and how to go from one to the next.
struct AnimationSampler {
  AnimationInterpolation interpolation = AnimationInterpolation::linear;
  std::size_t width = 0;                              ///< numbers per value: 3, 4 or as many as there are morph targets
  std::shared_ptr<const std::vector<float>> times_s;  ///< at least one, from 0 on, ascending strictly
  std::shared_ptr<const std::vector<float>> values;   ///< one per time; cubic: in-tangent, value and out-tangent
};

/// Before the first time it is the first value, after the last time the last. Rotations go the shorter way, at a
/// constant rate if linear, and are of unit length. `value` has sampler.width numbers.
void sample_animation(const AnimationSampler& sampler, AnimatedProperty property, double time_s,
                      std::span<double> value);

struct AnimationChannel {
  std::size_t node = 0;  ///< of PartAnimations::nodes
  AnimatedProperty property = AnimatedProperty::translation;
  std::size_t sampler = 0;  ///< of the clip
};

struct AnimationClip {
  std::string name;
  double duration_s = 0;  ///< the last time of all its channels
  std::vector<AnimationSampler> samplers;
  std::vector<AnimationChannel> channels;  ///< no two of the same property of the same node
};

/// A node of the file's tree that a clip moves, or that moves a joint. Its frame need not be in the graph.
struct AnimatedNode {
  int parent = -1;  ///< its number is lower; -1: the part's root, in the file's axes
  LocalPose rest;   ///< of nodes that a clip moves
  glm::dmat4 parent_from_node_at_rest{1};
  std::vector<double> weights_at_rest;         ///< of the morph targets, if a clip changes them
  std::shared_ptr<const Transform> transform;  ///< in the graph; null if no clip moves it or it is not shown
};

/// Frames   the joints are nodes; joint_from_mesh takes the mesh as it was bound to the joint's frame.
struct AnimatedSkin {
  std::vector<std::size_t> joints;
  std::vector<glm::dmat4> joint_from_mesh;
};

/// A shape whose mesh a clip deforms.
struct AnimatedShape {
  std::shared_ptr<const Shape> shape;
  std::shared_ptr<const DeformableMesh> mesh;
  int node = -1;                        ///< whose weights its targets have; -1: it has none that a clip changes
  int skin = -1;                        ///< -1: none. Skinned shapes stand at the part's root, in the file's axes
  std::vector<double> weights_at_rest;  ///< one for each target of the mesh, or none for zeros
};

/// Every pose that a clip can bring about is finite in float32: see animation_overflow().
struct PartAnimations {
  std::vector<AnimationClip> clips;
  std::vector<AnimatedNode> nodes;  ///< parents before children
  std::vector<AnimatedSkin> skins;
  std::vector<AnimatedShape> shapes;
};

/// For each node, whether a clip's channel moves it or one of its ancestors.
std::vector<bool> nodes_moved_by(const PartAnimations& animations, const AnimationClip& clip);

}  // namespace simvis
