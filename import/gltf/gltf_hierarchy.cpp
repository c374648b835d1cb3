#include "import/gltf/gltf_hierarchy.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "import/gltf/gltf_accessors.h"

namespace simvis {
namespace {

// Quaternions in files are rounded to a few digits or to normalised bytes (half a step in each of 4 components: 0.008).
// A larger deviation from unit length is an error of the file.
constexpr double kUnitTolerance = 0.01;

std::string place_of(std::size_t node) { return "nodes/" + std::to_string(node); }

bool is_finite(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(m[column][row])) return false;
    }
  }
  return true;
}

glm::dmat4 local_matrix(const GltfDocument& document, std::size_t index) {
  const tinygltf::Node& node = document.model.nodes[index];
  if (!node.matrix.empty()) {
    glm::dmat4 m;
    for (std::size_t i = 0; i < 16; ++i) m[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = node.matrix[i];
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1) {
      document.fail(place_of(index) + "/matrix is not affine; expected 0, 0, 0, 1 as its last row");
    }
    return m;
  }
  return matrix_of(read_local_pose(document, index));
}

// A node with several parents stays with the first.
std::vector<int> parents_of(GltfDocument& document) {
  std::vector<tinygltf::Node>& nodes = document.model.nodes;
  std::vector<int> parents(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::erase_if(nodes[i].children, [&](int child) {
      int& parent = parents[static_cast<std::size_t>(child)];
      if (parent < 0) {
        parent = static_cast<int>(i);
        return false;
      }
      document.warn(place_of(static_cast<std::size_t>(child)) + " has two parents, " +
                    place_of(static_cast<std::size_t>(parent)) + " and " + place_of(i) +
                    "; it is left out of the second");
      return true;
    });
  }
  return parents;
}

std::vector<int> nodes_without_parents(const std::vector<int>& parents) {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    if (parents[i] < 0) nodes.push_back(static_cast<int>(i));
  }
  return nodes;
}

bool is_below(int node, const std::vector<int>& tops, const std::vector<int>& parents) {
  std::size_t steps = 0;  // parents may form a cycle
  for (int above = parents[static_cast<std::size_t>(node)]; above >= 0 && ++steps <= parents.size();) {
    if (std::ranges::find(tops, above) != tops.end()) return true;
    above = parents[static_cast<std::size_t>(above)];
  }
  return false;
}

// A root that another root has below it stands there alone; one that a node outside of the scene has leaves that one.
std::vector<int> scene_roots(GltfDocument& document, std::vector<int>& parents) {
  tinygltf::Model& model = document.model;
  if (model.scenes.empty()) return nodes_without_parents(parents);
  const std::size_t scene = model.defaultScene < 0 ? 0 : static_cast<std::size_t>(model.defaultScene);
  const std::vector<int>& tops = model.scenes[scene].nodes;
  std::vector<int> roots;
  std::set<int> seen;
  for (const int node : tops) {
    const std::string place = "scenes/" + std::to_string(scene) + " has ";
    const auto index = static_cast<std::size_t>(node);
    if (!seen.insert(node).second) document.fail(place + place_of(index) + " twice");
    const bool is_child = is_below(node, tops, parents);
    if (!is_child) roots.push_back(node);
    const int parent = parents[index];
    if (parent < 0) continue;
    document.warn(place + "the root " + place_of(index) + ", which is a child of " +
                  place_of(static_cast<std::size_t>(parent)) + "; it is read as a " + (is_child ? "child" : "root") +
                  " alone");
    if (is_child) continue;
    std::erase(model.nodes[static_cast<std::size_t>(parent)].children, node);
    parents[index] = -1;
  }
  return roots;
}

}  // namespace

std::optional<glm::dvec4> unit_quaternion(const glm::dvec4& q) {
  const double length = glm::length(q);
  if (!(std::abs(length - 1) <= kUnitTolerance)) return std::nullopt;
  return q / length;
}

LocalPose read_local_pose(const GltfDocument& document, std::size_t index) {
  const tinygltf::Node& node = document.model.nodes[index];
  LocalPose pose;
  if (!node.translation.empty()) pose.translation = {node.translation[0], node.translation[1], node.translation[2]};
  if (!node.scale.empty()) pose.scale = {node.scale[0], node.scale[1], node.scale[2]};
  if (!node.rotation.empty()) {
    const auto unit = unit_quaternion({node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]});
    if (!unit) document.fail(place_of(index) + "/rotation is not a unit quaternion");
    pose.rotation = *unit;
  }
  return pose;
}

GltfHierarchy read_hierarchy(GltfDocument& document) {
  const std::vector<tinygltf::Node>& nodes = document.model.nodes;
  GltfHierarchy hierarchy;
  hierarchy.parents = parents_of(document);
  std::vector<int>& parents = hierarchy.parents;
  hierarchy.roots = scene_roots(document, parents);
  hierarchy.parent_from_node.resize(nodes.size());
  hierarchy.root_from_node.resize(nodes.size());
  // Each node has at most one parent, so only the nodes of cycles are never reached.
  std::vector<int>& order = hierarchy.order;
  order = nodes_without_parents(parents);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto index = static_cast<std::size_t>(order[i]);
    const glm::dmat4 local = local_matrix(document, index);
    const int parent = parents[index];
    hierarchy.parent_from_node[index] = local;
    hierarchy.root_from_node[index] =
        parent < 0 ? local : hierarchy.root_from_node[static_cast<std::size_t>(parent)] * local;
    if (!is_finite(hierarchy.root_from_node[index])) document.fail(place_of(index) + " stands where nothing is finite");
    order.insert(order.end(), nodes[index].children.begin(), nodes[index].children.end());
  }
  if (order.size() != nodes.size()) document.fail("has nodes whose children form a cycle; expected trees");
  return hierarchy;
}

std::vector<glm::dmat4> read_instances(const GltfDocument& document, int node) {
  const GltfUse translation_use{"TRANSLATION", kGltfVec3, kGltfF32}, scale_use{"SCALE", kGltfVec3, kGltfF32};
  const GltfUse rotation_use{"ROTATION", kGltfVec4, kGltfF32 | kGltfI8n | kGltfI16n};
  const auto index = static_cast<std::size_t>(node);
  const tinygltf::ExtensionMap& extensions = document.model.nodes[index].extensions;
  const auto extension = extensions.find("EXT_mesh_gpu_instancing");
  if (extension == extensions.end()) return {};
  const tinygltf::Value& attributes = extension->second.Get("attributes");
  std::size_t count = 0;
  const auto read = [&](const GltfUse& use) {
    GltfFloats floats;
    if (!attributes.IsObject() || !attributes.Has(use.name)) return floats;
    floats = read_floats(document, attributes.Get(use.name).GetNumberAsInt(), use);
    if (count != 0 && floats.count != count) document.fail(place_of(index) + " has instances of different numbers");
    count = floats.count;
    return floats;
  };
  const GltfFloats translations = read(translation_use), rotations = read(rotation_use), scales = read(scale_use);
  std::vector<glm::dmat4> instances(count);
  for (std::size_t i = 0; i < count; ++i) {
    LocalPose pose;
    if (translations.count != 0) pose.translation = {translations[i][0], translations[i][1], translations[i][2]};
    if (scales.count != 0) pose.scale = {scales[i][0], scales[i][1], scales[i][2]};
    if (rotations.count != 0) {
      const auto unit = unit_quaternion({rotations[i][0], rotations[i][1], rotations[i][2], rotations[i][3]});
      if (!unit) document.fail(place_of(index) + " has an instance whose rotation is not a unit quaternion");
      pose.rotation = *unit;
    }
    instances[i] = matrix_of(pose);
  }
  return instances;
}

std::vector<glm::dmat4> read_inverse_bind_matrices(const GltfDocument& document, int skin) {
  constexpr int kMat4[] = {TINYGLTF_TYPE_MAT4};
  const GltfUse inverse_bind_use{"inverseBindMatrices", kMat4, kGltfF32};
  const tinygltf::Skin& source = document.model.skins[static_cast<std::size_t>(skin)];
  std::vector<glm::dmat4> matrices(source.joints.size(), glm::dmat4(1));
  if (source.inverseBindMatrices < 0) return matrices;
  const GltfFloats inverse_bind = read_floats(document, source.inverseBindMatrices, inverse_bind_use);
  if (inverse_bind.count < matrices.size()) {
    document.fail("skins/" + std::to_string(skin) + " has " + std::to_string(matrices.size()) + " joints, but " +
                  std::to_string(inverse_bind.count) + " inverse bind matrices");
  }
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    for (int k = 0; k < 16; ++k) matrices[i][k / 4][k % 4] = inverse_bind[i][k];
  }
  return matrices;
}

std::vector<glm::dmat4> read_joint_matrices(const GltfDocument& document, const GltfHierarchy& hierarchy, int skin) {
  std::vector<glm::dmat4> matrices = read_inverse_bind_matrices(document, skin);
  const std::vector<int>& joints = document.model.skins[static_cast<std::size_t>(skin)].joints;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    matrices[i] = hierarchy.root_from_node[static_cast<std::size_t>(joints[i])] * matrices[i];
  }
  return matrices;
}

}  // namespace simvis
