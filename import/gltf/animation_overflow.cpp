#include "import/gltf/animation_overflow.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace simvis {
namespace {

constexpr double kFloatMax = std::numeric_limits<float>::max();
// The largest magnitude on [0, 1] of Hermite's two tangent polynomials, t^3 - 2 t^2 + t and t^3 - t^2.
constexpr double kTangentShare = 4.0 / 27;

// Returns the largest length of m * v for a unit vector v: the square root of the largest eigenvalue of the symmetric
// matrix transpose(m) * m. A looser bound would grow along chains of nodes without any stretch.
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

// Upper bounds for an affine map: the stretch of a vector, and the displacement of the origin.
struct Reach {
  double stretch = 1, move = 0;
};

// Returns the largest magnitude of each component at any time.
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

// Upper bounds at any time of any clip, for each node's frame and each of its morph weights.
struct LargestPoses {
  std::vector<Reach> root_from_node;
  std::vector<std::vector<double>> weights;
};

void raise(double& largest, double value) { largest = std::max(largest, value); }

LargestPoses largest_poses(const PartAnimations& animations) {
  LargestPoses poses;
  for (const AnimatedNode& node : animations.nodes) {
    const glm::dmat4& m = node.parent_from_node_at_rest;
    poses.root_from_node.push_back({largest_stretch(glm::dmat3(m)), glm::length(glm::dvec3(m[3]))});
    poses.weights.emplace_back();
    for (const double weight : node.weights_at_rest) poses.weights.back().push_back(std::abs(weight));
  }
  for (const AnimationClip& clip : animations.clips) {
    for (const AnimationChannel& channel : clip.channels) {
      const std::vector<double> largest = largest_values(clip.samplers[channel.sampler]);
      Reach& own = poses.root_from_node[channel.node];
      switch (channel.property) {
        case AnimatedProperty::translation:
          raise(own.move, glm::length(glm::dvec3(largest[0], largest[1], largest[2])));
          break;
        case AnimatedProperty::scale:
          for (const double scale : largest) raise(own.stretch, scale);
          break;
        case AnimatedProperty::weights:
          for (std::size_t t = 0; t < largest.size(); ++t) raise(poses.weights[channel.node][t], largest[t]);
          break;
        case AnimatedProperty::rotation:
          break;
      }
    }
  }
  for (std::size_t i = 0; i < animations.nodes.size(); ++i) {
    if (animations.nodes[i].parent < 0) continue;
    const Reach parent = poses.root_from_node[static_cast<std::size_t>(animations.nodes[i].parent)];
    Reach& own = poses.root_from_node[i];
    own = {parent.stretch * own.stretch, parent.stretch * own.move + parent.move};
  }
  return poses;
}

double farthest(const std::vector<glm::vec3>& points) {
  double distance = 0;
  for (const glm::vec3& point : points) raise(distance, glm::length(glm::dvec3(point)));
  return distance;
}

// Returns the largest ratio of the sum of a vertex's absolute weights to the sum of its weights.
double heaviest(const DeformableMesh& mesh) {
  double ratio = 1;
  for (std::size_t i = 0; i < mesh.influences.size(); i += mesh.influences_per_vertex) {
    double sum = 0, size = 0;
    for (std::size_t k = 0; k < mesh.influences_per_vertex; ++k) {
      sum += mesh.influences[i + k].weight;
      size += std::abs(static_cast<double>(mesh.influences[i + k].weight));
    }
    raise(ratio, size / sum);
  }
  return ratio;
}

bool stays_finite(const PartAnimations& animations, const AnimatedShape& shape, const LargestPoses& poses) {
  const DeformableMesh& mesh = *shape.mesh;
  const std::vector<double>& weights =
      shape.node < 0 ? shape.weights_at_rest : poses.weights[static_cast<std::size_t>(shape.node)];
  double vertex = farthest(mesh.base.positions);
  for (std::size_t t = 0; t < weights.size(); ++t) {
    vertex += std::abs(weights[t]) * farthest(mesh.targets[t].position_changes);
  }
  if (shape.skin < 0) return vertex <= kFloatMax;
  const double weighed = heaviest(mesh) * (vertex + 1);  // the 1 is the homogeneous coordinate
  const AnimatedSkin& skin = animations.skins[static_cast<std::size_t>(shape.skin)];
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    const Reach& joint = poses.root_from_node[skin.joints[j]];
    if (!((joint.stretch + joint.move + 1) * norm(skin.joint_from_mesh[j]) * weighed <= kFloatMax)) return false;
  }
  return true;
}

}  // namespace

std::string animation_overflow(const PartAnimations& animations) {
  const LargestPoses poses = largest_poses(animations);
  for (const Reach& node : poses.root_from_node) {
    if (!(node.stretch <= kFloatMax && node.move <= kFloatMax)) return "a node";
  }
  for (const AnimatedShape& shape : animations.shapes) {
    if (!stays_finite(animations, shape, poses)) return "a vertex, by its morph targets or joints,";
  }
  return "";
}

}  // namespace simvis
