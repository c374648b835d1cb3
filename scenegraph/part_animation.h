// The animations of a part's file, whatever its format: clips of keys over time, and the nodes and shapes of the part's
// graph that they move.
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

/// The pose of a node in its parent's frame: scaled first, then rotated, then translated.
struct LocalPose {
  glm::dvec3 translation{0};        ///< in the parent's frame
  glm::dvec4 rotation{0, 0, 0, 1};  ///< a unit quaternion x, y, z, w
  glm::dvec3 scale{1};              ///< along the axes of the node
};

/// The matrix parent_from_node of a pose.
glm::dmat4 matrix_of(const LocalPose& pose);

/// How values between two keys are computed.
enum class AnimationInterpolation : std::uint8_t {
  step,         ///< the value of the earlier key
  linear,       ///< linear; rotations: spherical linear
  cubic_spline  ///< cubic Hermite spline with tangents
};
/// What a channel animates.
enum class AnimatedProperty : std::uint8_t {
  translation,  ///< LocalPose::translation
  rotation,     ///< LocalPose::rotation
  scale,        ///< LocalPose::scale
  weights       ///< weights of the morph targets
};

/// Keys over time and their interpolation.
struct AnimationSampler {
  AnimationInterpolation interpolation = AnimationInterpolation::linear;  ///< between two keys
  std::size_t width = 0;                              ///< numbers per value: 3, 4 or the number of morph targets
  std::shared_ptr<const std::vector<float>> times_s;  ///< at least one, the first >= 0, strictly ascending
  std::shared_ptr<const std::vector<float>> values;   ///< one per time; cubic: in-tangent, value and out-tangent
};

/// Evaluates a sampler. Before the first time the result is the first value, after the last time the last value.
/// Rotations take the shorter way, at a constant rate if linear, and have unit length. `value` has sampler.width
/// numbers.
void sample_animation(const AnimationSampler& sampler, AnimatedProperty property, double time_s,
                      std::span<double> value);

/// One property of one node, animated by one sampler.
struct AnimationChannel {
  std::size_t node = 0;                                       ///< in PartAnimations::nodes
  AnimatedProperty property = AnimatedProperty::translation;  ///< what is animated
  std::size_t sampler = 0;                                    ///< in AnimationClip::samplers
};

/// One animation of the file.
struct AnimationClip {
  std::string name;                        ///< as in the file
  double duration_s = 0;                   ///< the last time of all its channels
  std::vector<AnimationSampler> samplers;  ///< keys
  std::vector<AnimationChannel> channels;  ///< no two animate the same property of the same node
};

/// A node of the file's tree that a clip moves, or that moves a joint. Its frame need not be in the graph.
struct AnimatedNode {
  int parent = -1;                             ///< a lower number; -1: the part's root, in the file's axes
  LocalPose rest;                              ///< pose without animation, of nodes that a clip moves
  glm::dmat4 parent_from_node_at_rest{1};      ///< matrix without animation
  std::vector<double> weights_at_rest;         ///< of the morph targets, if a clip changes them
  std::shared_ptr<const Transform> transform;  ///< in the graph; null if no clip moves it or it is not shown
};

/// A skin: the joints that deform a mesh.
struct AnimatedSkin {
  std::vector<std::size_t> joints;          ///< in PartAnimations::nodes
  std::vector<glm::dmat4> joint_from_mesh;  ///< by joint: from the mesh's frame in bind pose to the joint's frame
};

/// A shape whose mesh a clip deforms.
struct AnimatedShape {
  std::shared_ptr<const Shape> shape;          ///< in the graph
  std::shared_ptr<const DeformableMesh> mesh;  ///< its mesh before deformation
  int node = -1;  ///< the node that has the weights of its targets; -1: no clip changes weights
  int skin = -1;  ///< in PartAnimations::skins; -1: none. Skinned shapes are at the part's root, in the file's axes
  std::vector<double> weights_at_rest;  ///< one for each target of the mesh; empty: zeros
};

/// All animations of a part. Every pose that a clip can produce is finite in float32: see animation_overflow().
struct PartAnimations {
  std::vector<AnimationClip> clips;   ///< in the order of the file
  std::vector<AnimatedNode> nodes;    ///< parents before children
  std::vector<AnimatedSkin> skins;    ///< of the shapes
  std::vector<AnimatedShape> shapes;  ///< shapes with deformed meshes
};

/// For each node, whether a channel of the clip moves it or one of its ancestors.
std::vector<bool> nodes_moved_by(const PartAnimations& animations, const AnimationClip& clip);

}  // namespace simvis
