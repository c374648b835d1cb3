#include "scenegraph/animation_overflow.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace simvis {
namespace {

constexpr double kFloatMax = std::numeric_limits<float>::max();
// Of Hermite's two tangent polynomials, t^3 - 2 t^2 + t and t^3 - t^2: the largest size on [0, 1].
constexpr double kTangentShare = 4.0 / 27;

// The largest length of m * v for a v of length 1: the root of the largest eigenvalue of the symmetric transpose(m) *
// m. A mere bound would grow along chains of nodes that stretch nothing.
double largest_stretch(const glm::dmat3& m) {
  glm::dmat3 s = glm::transpose(m) * m;
  const double mean = (s[0][0] + s[1][1] + s[2][2]) / 3;
  for (int i = 0; i < 3; ++i) s[i][i] -= mean;
  const double spread = std::sqrt((glm::dot(s[0], s[0]) + glm::dot(s[1], s[1]) + glm::dot(s[2], s[2])) / 6);
  if (spread == 0) return std::sqrt(mean);
  const double angle = std::acos(std::clamp(glm::determinant(s / spread) / 2, -1.0, 1.0)) / 3;
  return std::sqrt(mean + 2 * spread * std::cos(angle));
}

double norm(const glm::dmat4& m) {
  double sum = 0;
  for (int column = 0; column < 4; ++column) sum += glm::dot(m[column], m[column]);
  return std::sqrt(sum);
}

// How far an affine map stretches a vector at most, and how far it moves the origin at most.
struct Reach {
  double stretch = 1, move = 0;
};

// The largest size of each component at any time.
std::vector<double> largest_values(const AnimationSampler& sampler) {
  const bool cubic = sampler.interpolation == AnimationInterpolation::cubic_spline;
  const std::vector<float>& times = *sampler.times_s;
  double longest_s = 0;
  for (std::size_t k = 1; k < times.size(); ++k) {
    longest_s = std::max(longest_s, static_cast<double>(times[k]) - times[k - 1]);
  }
  std::vector<double> value(sampler.width, 0), tangent(sampler.width, 0);
  for (std::size_t i = 0; i < sampler.values->size(); ++i) {
    const bool is_tangent = cubic && i / sampler.width % 3 != 1;
    double& largest = (is_tangent ? tangent : value)[i % sampler.width];
    largest = std::max(largest, std::abs(static_cast<double>((*sampler.values)[i])));
  }
  for (std::size_t i = 0; i < sampler.width; ++i) value[i] += 2 * kTangentShare * longest_s * tangent[i];
  return value;
}

// One clip: every node's reach from the root, and the largest size of every weight.
struct ClipReach {
  std::vector<Reach> nodes;
  std::vector<std::vector<double>> weights;
};

ClipReach reach_of(const PartAnimations& animations, const AnimationClip& clip) {
  ClipReach reach;
  for (const AnimatedNode& node : animations.nodes) {
    const glm::dmat4& m = node.parent_from_node_at_rest;
    reach.nodes.push_back({largest_stretch(glm::dmat3(m)), glm::length(glm::dvec3(m[3]))});
    reach.weights.emplace_back();
    for (const double weight : node.weights_at_rest) reach.weights.back().push_back(std::abs(weight));
  }
  std::vector<glm::dvec3> scales;
  for (const AnimatedNode& node : animations.nodes) scales.push_back(glm::abs(node.rest.scale));
  for (const AnimationChannel& channel : clip.channels) {
    const std::vector<double> largest = largest_values(clip.samplers[channel.sampler]);
    if (channel.property == AnimatedProperty::weights) {
      reach.weights[channel.node] = largest;
      continue;
    }
    if (channel.property == AnimatedProperty::scale) scales[channel.node] = {largest[0], largest[1], largest[2]};
    if (channel.property == AnimatedProperty::translation) {
      reach.nodes[channel.node].move = glm::length(glm::dvec3(largest[0], largest[1], largest[2]));
    }
    const glm::dvec3& scale = scales[channel.node];
    reach.nodes[channel.node].stretch = std::max({scale.x, scale.y, scale.z});
  }
  for (std::size_t i = 0; i < reach.nodes.size(); ++i) {
    if (animations.nodes[i].parent < 0) continue;
    const Reach parent = reach.nodes[static_cast<std::size_t>(animations.nodes[i].parent)];
    Reach& own = reach.nodes[i];
    own = {parent.stretch * own.stretch, parent.stretch * own.move + parent.move};
  }
  return reach;
}

// The largest distance of a vertex from the origin of its mesh, and how much joints weigh at most.
double vertex_reach(const AnimatedShape& shape, const ClipReach& reach) {
  const DeformableMesh& mesh = *shape.mesh;
  const std::vector<double>& weights =
      shape.node < 0 ? shape.weights_at_rest : reach.weights[static_cast<std::size_t>(shape.node)];
  double farthest = 0, heaviest = 1;
  for (std::size_t i = 0; i < mesh.base.positions.size(); ++i) {
    double distance = glm::length(glm::dvec3(mesh.base.positions[i]));
    for (std::size_t t = 0; t < weights.size(); ++t) {
      if (mesh.targets[t].position_changes.empty()) continue;
      distance += std::abs(weights[t]) * glm::length(glm::dvec3(mesh.targets[t].position_changes[i]));
    }
    farthest = std::max(farthest, distance);
    double sum = 0, size = 0;
    for (std::size_t k = 0; k < mesh.influences_per_vertex; ++k) {
      const double weight = mesh.influences[i * mesh.influences_per_vertex + k].weight;
      sum += weight;
      size += std::abs(weight);
    }
    if (size > 0) heaviest = std::max(heaviest, size / sum);
  }
  return farthest * heaviest + heaviest;
}

bool shape_stays_finite(const PartAnimations& animations, const AnimatedShape& shape, const ClipReach& reach) {
  const double vertex = vertex_reach(shape, reach);
  if (shape.skin < 0) return vertex <= kFloatMax;
  const AnimatedSkin& skin = animations.skins[static_cast<std::size_t>(shape.skin)];
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    const Reach& joint = reach.nodes[skin.joints[j]];
    if (!((joint.stretch + joint.move + 1) * norm(skin.joint_from_mesh[j]) * vertex <= kFloatMax)) return false;
  }
  return true;
}

}  // namespace

std::string animation_overflow(const PartAnimations& animations, std::size_t& clip) {
  for (clip = 0; clip < animations.clips.size(); ++clip) {
    const ClipReach reach = reach_of(animations, animations.clips[clip]);
    const std::vector<bool> moved = nodes_moved_by(animations, animations.clips[clip]);
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const Reach& node = reach.nodes[i];
      if (moved[i] && !(node.stretch <= kFloatMax && node.move <= kFloatMax)) {
        return "can move a node to where float32 is not finite";
      }
    }
    for (const AnimatedShape& shape : animations.shapes) {
      if (!shape_stays_finite(animations, shape, reach)) {
        return "can move a vertex, by its morph targets or joints, to where float32 is not finite";
      }
    }
  }
  return "";
}

}  // namespace simvis
