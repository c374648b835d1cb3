// Reads the morph targets and joint influences that deform the meshes of a file.
#include <map>
#include <string>
#include <utility>

#include "import/gltf/gltf_accessors.h"
#include "import/gltf/gltf_primitive.h"

namespace simvis {
namespace {

constexpr GltfUse kMorphPosition{"POSITION of a morph target", kGltfVec3, kGltfF32,
                                 kGltfI8 | kGltfI16 | kGltfI8n | kGltfI16n};
constexpr GltfUse kMorphNormal{"NORMAL of a morph target", kGltfVec3, kGltfF32, kGltfI8n | kGltfI16n};
constexpr GltfUse kJoints{"JOINTS", kGltfVec4, kGltfU8 | kGltfU16};
constexpr GltfUse kWeights{"WEIGHTS", kGltfVec4, kGltfF32 | kGltfU8n | kGltfU16n};
constexpr std::size_t kJointsPerSet = 4;

std::vector<glm::vec3> read_changes(const GltfDocument& document, const std::map<std::string, int>& target,
                                    const char* attribute, const GltfUse& use, std::size_t vertices) {
  const auto found = target.find(attribute);
  if (found == target.end()) return {};
  const GltfFloats floats = read_vertex_floats(document, found->second, use, vertices);
  std::vector<glm::vec3> changes(vertices);
  for (std::size_t i = 0; i < vertices; ++i) changes[i] = {floats[i][0], floats[i][1], floats[i][2]};
  return changes;
}

void read_targets(const GltfDocument& document, const tinygltf::Primitive& source, std::span<const double> weights,
                  bool weights_change, bool has_normals, DeformableMesh& mesh) {
  if (source.targets.empty() || (weights.empty() && !weights_change)) return;
  if (!weights.empty() && weights.size() != source.targets.size()) {
    document.fail("has " + std::to_string(weights.size()) + " morph weights for a primitive of " +
                  std::to_string(source.targets.size()) + " targets");
  }
  const std::size_t vertices = mesh.base.positions.size();
  mesh.targets.resize(source.targets.size());
  for (std::size_t t = 0; t < source.targets.size(); ++t) {
    if (!weights_change && weights[t] == 0) continue;
    MorphTarget& target = mesh.targets[t];
    target.position_changes = read_changes(document, source.targets[t], "POSITION", kMorphPosition, vertices);
    if (!has_normals) continue;
    target.normal_changes = read_changes(document, source.targets[t], "NORMAL", kMorphNormal, vertices);
  }
}

// Checks the weights of each vertex. If all weights of a skinned vertex are zero, the vertex follows its first joint.
void check_weights(GltfDocument& document, DeformableMesh& mesh) {
  for (std::size_t i = 0; i < mesh.influences.size(); i += mesh.influences_per_vertex) {
    double sum = 0;
    for (std::size_t k = 0; k < mesh.influences_per_vertex; ++k) sum += mesh.influences[i + k].weight;
    if (sum == 0) {
      document.warn("skinned vertices without weights follow their first joint");
      for (std::size_t k = 0; k < mesh.influences_per_vertex; ++k) mesh.influences[i + k].weight = k == 0 ? 1.0f : 0.0f;
      continue;
    }
    if (!(sum > 0)) document.fail("has a skinned vertex whose weights sum to " + std::to_string(sum) + "; expected 1");
  }
}

// Reads all sets of joints and weights.
void read_influences(GltfDocument& document, const tinygltf::Primitive& source, std::size_t joints,
                     DeformableMesh& mesh) {
  const std::size_t vertices = mesh.base.positions.size();
  std::size_t sets = 0;
  while (source.attributes.count("JOINTS_" + std::to_string(sets)) != 0) ++sets;
  if (sets == 0) document.fail("has a skinned primitive without JOINTS_0 and WEIGHTS_0");
  mesh.influences_per_vertex = sets * kJointsPerSet;
  mesh.influences.resize(vertices * mesh.influences_per_vertex);
  for (std::size_t set = 0; set < sets; ++set) {
    const int joint_accessor = source.attributes.at("JOINTS_" + std::to_string(set));
    const auto weights = source.attributes.find("WEIGHTS_" + std::to_string(set));
    if (weights == source.attributes.end()) document.fail("has a skinned primitive with JOINTS but without WEIGHTS");
    // Floats are exact for 16-bit integers.
    const GltfFloats joint_floats = read_vertex_floats(document, joint_accessor, kJoints, vertices);
    const GltfFloats weight_floats = read_vertex_floats(document, weights->second, kWeights, vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
      for (std::size_t k = 0; k < kJointsPerSet; ++k) {
        const auto joint = static_cast<std::uint32_t>(joint_floats[i][k]);
        if (joint >= joints) {
          document.fail("accessors/" + std::to_string(joint_accessor) + " (JOINTS) has the joint " +
                        std::to_string(joint) + ", but the skin has " + std::to_string(joints));
        }
        mesh.influences[i * mesh.influences_per_vertex + set * kJointsPerSet + k] = {joint, weight_floats[i][k]};
      }
    }
  }
  check_weights(document, mesh);
}

}  // namespace

DeformableMesh read_deformable(GltfDocument& document, const tinygltf::Primitive& source, GltfPrimitive&& primitive,
                               std::span<const double> weights, bool weights_change, int joints) {
  DeformableMesh mesh;
  mesh.flat_normals = primitive.needs_flat_normals();
  mesh.base = std::move(primitive.mesh);
  read_targets(document, source, weights, weights_change, primitive.has_normals, mesh);
  if (joints >= 0) read_influences(document, source, static_cast<std::size_t>(joints), mesh);
  return mesh;
}

}  // namespace simvis
