// Morph targets and skins, taken at their rest: the default weights and the pose of the file's nodes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "scenegraph/gltf_accessors.h"
#include "scenegraph/gltf_primitive.h"

namespace simvis {
namespace {

constexpr int kVec3[] = {TINYGLTF_TYPE_VEC3};
constexpr int kVec4[] = {TINYGLTF_TYPE_VEC4};
constexpr GltfUse kMorphPosition{"POSITION of a morph target", kVec3, kGltfF32,
                                 kGltfI8 | kGltfI16 | kGltfI8n | kGltfI16n};
constexpr GltfUse kMorphNormal{"NORMAL of a morph target", kVec3, kGltfF32, kGltfI8n | kGltfI16n};
constexpr GltfUse kJoints{"JOINTS", kVec4, kGltfU8 | kGltfU16};
constexpr GltfUse kWeights{"WEIGHTS", kVec4, kGltfF32 | kGltfU8n | kGltfU16n};
constexpr std::size_t kJointsPerSet = 4;

void check_count(const GltfDocument& document, int accessor, const char* use, std::size_t count, std::size_t vertices) {
  if (count == vertices) return;
  document.fail("accessors/" + std::to_string(accessor) + " (" + use + ") has " + std::to_string(count) +
                " elements; expected " + std::to_string(vertices) + ", as many as POSITION");
}

// Sum over the targets of weight * difference, in double.
std::vector<glm::dvec3> weighted_differences(const GltfDocument& document, const tinygltf::Primitive& source,
                                             std::span<const double> weights, const char* attribute, const GltfUse& use,
                                             std::size_t vertices) {
  std::vector<glm::dvec3> sum(vertices, glm::dvec3(0));
  for (std::size_t t = 0; t < source.targets.size(); ++t) {
    const auto found = source.targets[t].find(attribute);
    if (weights[t] == 0 || found == source.targets[t].end()) continue;
    const GltfFloats floats = read_floats(document, found->second, use);
    check_count(document, found->second, use.name, floats.count, vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
      sum[i] += weights[t] * glm::dvec3(floats[i][0], floats[i][1], floats[i][2]);
    }
  }
  return sum;
}

glm::vec3 rounded_position(const GltfDocument& document, const glm::dvec3& position) {
  constexpr double kFloatMax = std::numeric_limits<float>::max();
  const glm::dvec3 size = glm::abs(position);
  if (!(size.x <= kFloatMax && size.y <= kFloatMax && size.z <= kFloatMax)) {
    document.fail("has a vertex that its morph targets or joints move to where float32 is not finite");
  }
  return glm::vec3(position);
}

glm::vec3 unit_or(const glm::dvec3& v, const glm::vec3& otherwise) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
}

struct Influence {
  std::uint32_t joint;
  double weight;
};

// All sets of joints and weights; vertex i's influences are the `per_vertex` from i * per_vertex on.
struct Influences {
  std::size_t per_vertex = 0;
  std::vector<Influence> values;
};

Influences read_influences(const GltfDocument& document, const tinygltf::Primitive& source, std::size_t vertices,
                           std::size_t joints) {
  std::size_t sets = 0;
  while (source.attributes.count("JOINTS_" + std::to_string(sets)) != 0) ++sets;
  if (sets == 0) document.fail("has a skinned primitive without JOINTS_0 and WEIGHTS_0");
  Influences influences{sets * kJointsPerSet, std::vector<Influence>(vertices * sets * kJointsPerSet)};
  for (std::size_t set = 0; set < sets; ++set) {
    const int joint_accessor = source.attributes.at("JOINTS_" + std::to_string(set));
    const auto weights = source.attributes.find("WEIGHTS_" + std::to_string(set));
    if (weights == source.attributes.end()) document.fail("has a skinned primitive with JOINTS but without WEIGHTS");
    const GltfFloats joint_floats = read_floats(document, joint_accessor, kJoints);  // 16 bits: exact
    const GltfFloats weight_floats = read_floats(document, weights->second, kWeights);
    check_count(document, joint_accessor, kJoints.name, joint_floats.count, vertices);
    check_count(document, weights->second, kWeights.name, weight_floats.count, vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
      for (std::size_t k = 0; k < kJointsPerSet; ++k) {
        const auto joint = static_cast<std::uint32_t>(joint_floats[i][k]);
        if (joint >= joints) {
          document.fail("accessors/" + std::to_string(joint_accessor) + " (JOINTS) has the joint " +
                        std::to_string(joint) + ", but the skin has " + std::to_string(joints));
        }
        influences.values[i * influences.per_vertex + set * kJointsPerSet + k] = {joint, weight_floats[i][k]};
      }
    }
  }
  return influences;
}

}  // namespace

void apply_morph_targets(const GltfDocument& document, const tinygltf::Primitive& source,
                         std::span<const double> weights, GltfPrimitive& primitive) {
  if (source.targets.empty() || weights.empty()) return;
  if (weights.size() != source.targets.size()) {
    document.fail("has " + std::to_string(weights.size()) + " morph weights for a primitive of " +
                  std::to_string(source.targets.size()) + " targets");
  }
  if (std::all_of(weights.begin(), weights.end(), [](double weight) { return weight == 0; })) return;
  Mesh& mesh = primitive.mesh;
  const std::size_t vertices = mesh.positions.size();
  const auto moves = weighted_differences(document, source, weights, "POSITION", kMorphPosition, vertices);
  const auto turns = weighted_differences(document, source, weights, "NORMAL", kMorphNormal, vertices);
  for (std::size_t i = 0; i < vertices; ++i) {
    mesh.positions[i] = rounded_position(document, glm::dvec3(mesh.positions[i]) + moves[i]);
    const glm::vec3 normal = mesh.attributes[i].normal;
    if (primitive.has_normals && turns[i] != glm::dvec3(0)) {
      mesh.attributes[i].normal = unit_or(glm::dvec3(normal) + turns[i], normal);
    }
  }
}

void apply_skin(GltfDocument& document, const tinygltf::Primitive& source, std::span<const glm::dmat4> joint_matrices,
                GltfPrimitive& primitive) {
  Mesh& mesh = primitive.mesh;
  const std::size_t vertices = mesh.positions.size();
  const Influences influences = read_influences(document, source, vertices, joint_matrices.size());
  for (std::size_t i = 0; i < vertices; ++i) {
    glm::dmat4 blend(0);
    double sum = 0;
    for (std::size_t k = 0; k < influences.per_vertex; ++k) {
      const Influence& influence = influences.values[i * influences.per_vertex + k];
      blend += influence.weight * joint_matrices[influence.joint];
      sum += influence.weight;
    }
    if (sum == 0) {
      document.warn("skinned vertices without weights follow their first joint");
      blend = joint_matrices[influences.values[i * influences.per_vertex].joint];
      sum = 1;
    }
    // Weights sum to one up to their own rounding, which the division takes out.
    if (!(sum > 0)) document.fail("has a skinned vertex whose weights sum to " + std::to_string(sum) + "; expected 1");
    blend /= sum;
    mesh.positions[i] = rounded_position(document, glm::dvec3(blend * glm::dvec4(mesh.positions[i], 1)));
    const glm::vec3 normal = mesh.attributes[i].normal;
    const glm::dvec3 turned = glm::transpose(glm::inverse(glm::dmat3(blend))) * glm::dvec3(normal);
    mesh.attributes[i].normal = unit_or(turned, normal);
  }
}

}  // namespace simvis
