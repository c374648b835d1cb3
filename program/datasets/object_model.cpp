#include "program/datasets/object_model.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <simvis/error.h>
#include "engine/base/fnv1a.h"

namespace simvis {
namespace {

/// Cosine between two axes below which they count as perpendicular.
constexpr double kPerpendicular = 1e-6;

double nine_digits(double value) {
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 8);
  return std::round(value / step) * step;
}

template <typename Number>
void put(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

}  // namespace

glm::dvec3 scale_of(const DrawList& list, std::uint32_t item, const std::string& what) {
  const glm::dmat3 axes(list.world_from_node[list.items[item].transform]);
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

std::uint64_t model_hash(const Mesh& mesh, const glm::dvec3& scale) {
  std::uint64_t hash = fnv1a(mesh.positions.data(), mesh.positions.size() * sizeof mesh.positions[0]);
  hash = fnv1a(mesh.indices.data(), mesh.indices.size() * sizeof mesh.indices[0], hash);
  return fnv1a(&scale, sizeof scale, hash);
}

ObjectModel object_model(const Mesh& mesh, const glm::dvec3& scale) {
  ObjectModel model{.positions_mm = {}, .normals = {}, .indices = mesh.indices};
  const glm::dvec3 middle = (glm::dvec3(mesh.bounds_min) + glm::dvec3(mesh.bounds_max)) / 2.0;
  model.low_mm = glm::dvec3(std::numeric_limits<double>::infinity());
  model.high_mm = -model.low_mm;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::dvec3 at = kMillimetres * scale * (glm::dvec3(mesh.positions[i]) - middle);
    model.positions_mm.emplace_back(at);
    model.low_mm = glm::min(model.low_mm, at);
    model.high_mm = glm::max(model.high_mm, at);
    const glm::dvec3 normal = glm::dvec3(mesh.attributes[i].normal) / scale;
    const double length = glm::length(normal);
    model.normals.emplace_back(length > 0 ? normal / length : glm::dvec3(0, 0, 1));
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
    for (int axis = 0; axis < 3; ++axis) put(bytes, model.positions_mm[i][axis]);
    for (int axis = 0; axis < 3; ++axis) put(bytes, model.normals[i][axis]);
  }
  for (std::size_t i = 0; i < model.indices.size(); i += 3) {
    put(bytes, std::uint8_t{3});
    for (std::size_t k = 0; k < 3; ++k) put(bytes, static_cast<std::int32_t>(model.indices[i + k]));
  }
  return bytes;
}

}  // namespace simvis
