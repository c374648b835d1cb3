#include "program/datasets/object_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <simvis/error.h>
#include "engine/base/binary_numbers.h"
#include "engine/base/fnv1a.h"

namespace simvis {
namespace {

/// Cosine between two axes below which they count as perpendicular.
constexpr double kPerpendicular = 1e-6;

double nine_digits(double value) {
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 8);
  return std::round(value / step) * step;
}

/// The mesh of a surface; null: it has no triangles.
const Mesh* mesh_of(const DrawList& list, const ObjectSurface& surface) {
  const Mesh& mesh = *list.meshes[list.items[surface.item].mesh];
  return mesh.topology == Topology::triangles && !mesh.indices.empty() ? &mesh : nullptr;
}

}  // namespace

glm::dvec3 scale_of(const DrawList& list, const SceneObject& object, const std::string& what) {
  const glm::dmat3 axes(list.world_from_node[object.transform]);
  glm::dvec3 scale;
  for (int axis = 0; axis < 3; ++axis) scale[axis] = glm::length(axes[axis]);
  const glm::dmat3 turned(axes[0] / scale[0], axes[1] / scale[1], axes[2] / scale[2]);
  const double skew = std::max({std::abs(glm::dot(turned[0], turned[1])), std::abs(glm::dot(turned[1], turned[2])),
                                std::abs(glm::dot(turned[0], turned[2]))});
  if (!(skew <= kPerpendicular) || glm::determinant(turned) < 0) {
    throw InputError(what + " is sheared or mirrored, which no rigid model can show, expected an even scale");
  }
  for (int axis = 0; axis < 3; ++axis) scale[axis] = nine_digits(scale[axis]);
  return scale;
}

bool has_model(const DrawList& list, const SceneObject& object) {
  return std::ranges::any_of(object.surfaces,
                             [&](const ObjectSurface& each) { return mesh_of(list, each) != nullptr; });
}

std::uint64_t model_hash(const DrawList& list, const SceneObject& object, const glm::dvec3& scale) {
  std::uint64_t hash = kFnv1aStart;
  for (const ObjectSurface& each : object.surfaces) {
    const Mesh* const mesh = mesh_of(list, each);
    if (mesh == nullptr) continue;
    hash = fnv1a(mesh->positions.data(), mesh->positions.size() * sizeof mesh->positions[0], hash);
    hash = fnv1a(mesh->indices.data(), mesh->indices.size() * sizeof mesh->indices[0], hash);
    if (each.frame_from_mesh != glm::dmat4(1)) hash = fnv1a(&each.frame_from_mesh, sizeof each.frame_from_mesh, hash);
  }
  return fnv1a(&scale, sizeof scale, hash);
}

ObjectModel object_model(const DrawList& list, const SceneObject& object, const glm::dvec3& scale) {
  ObjectModel model{.positions_mm = {}, .normals = {}, .indices = {}};
  const glm::dvec3 middle = (object.low_m + object.high_m) / 2.0;
  model.low_mm = glm::dvec3(std::numeric_limits<double>::infinity());
  model.high_mm = -model.low_mm;
  for (const ObjectSurface& each : object.surfaces) {
    const Mesh* const mesh = mesh_of(list, each);
    if (mesh == nullptr) continue;
    const auto first = static_cast<std::uint32_t>(model.positions_mm.size());
    const glm::dmat3 turned = glm::transpose(glm::inverse(glm::dmat3(each.frame_from_mesh)));
    for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
      const glm::dvec3 at =
          kMillimetres * scale * (glm::dvec3(each.frame_from_mesh * glm::dvec4(mesh->positions[i], 1)) - middle);
      model.positions_mm.emplace_back(at);
      model.low_mm = glm::min(model.low_mm, at);
      model.high_mm = glm::max(model.high_mm, at);
      const glm::dvec3 normal = turned * glm::dvec3(mesh->attributes[i].normal) / scale;
      const double length = glm::length(normal);
      model.normals.emplace_back(length > 0 ? normal / length : glm::dvec3(0, 0, 1));
    }
    // A mirrored mesh has its triangles the other way round.
    const bool is_mirrored = glm::determinant(glm::dmat3(each.frame_from_mesh)) < 0;
    for (std::size_t i = 0; i < mesh->indices.size(); i += 3) {
      const std::size_t second = is_mirrored ? i + 2 : i + 1, third = is_mirrored ? i + 1 : i + 2;
      for (const std::size_t corner : {i, second, third}) model.indices.push_back(first + mesh->indices[corner]);
    }
  }
  return model;
}

// Vertices are sorted by their distances from the middle. Two vertices are at most the sum of these distances apart, so
// the search ends where the sum is below the largest distance found.
double diameter_mm(const ObjectModel& model) {
  std::vector<glm::dvec3> points(model.positions_mm.begin(), model.positions_mm.end());
  std::ranges::sort(points, [](const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a, a) > glm::dot(b, b); });
  double farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double own = glm::length(points[i]);
    if (2 * own <= farthest) break;
    for (std::size_t k = i + 1; k < points.size() && own + glm::length(points[k]) > farthest; ++k) {
      farthest = std::max(farthest, glm::length(points[i] - points[k]));
    }
  }
  return farthest;
}

std::string model_ply(const ObjectModel& model) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(model.positions_mm.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
      "property float nz\nelement face " +
      std::to_string(model.indices.size() / 3) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < model.positions_mm.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) append_binary(bytes, model.positions_mm[i][axis]);
    for (int axis = 0; axis < 3; ++axis) append_binary(bytes, model.normals[i][axis]);
  }
  for (std::size_t i = 0; i < model.indices.size(); i += 3) {
    append_binary(bytes, std::uint8_t{3});
    for (std::size_t k = 0; k < 3; ++k) append_binary(bytes, static_cast<std::int32_t>(model.indices[i + k]));
  }
  return bytes;
}

}  // namespace simvis
