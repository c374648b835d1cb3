#include "scenegraph/mesh_deformation.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/base/assert.h"

namespace simvis {
namespace {

struct Vertex {
  glm::dvec3 position, normal;
};

bool fits_float(const glm::dvec3& position) {
  constexpr double kFloatMax = std::numeric_limits<float>::max();
  const glm::dvec3 size = glm::abs(position);
  return size.x <= kFloatMax && size.y <= kFloatMax && size.z <= kFloatMax;
}

glm::vec3 unit_or(const glm::dvec3& v, const glm::vec3& otherwise) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? glm::vec3(v / length) : otherwise;
}

void add_targets(const DeformableMesh& source, std::span<const double> weights, std::size_t i, Vertex& vertex) {
  for (std::size_t t = 0; t < weights.size(); ++t) {
    if (weights[t] == 0) continue;
    const MorphTarget& target = source.targets[t];
    if (!target.position_changes.empty()) vertex.position += weights[t] * glm::dvec3(target.position_changes[i]);
    if (!target.normal_changes.empty()) vertex.normal += weights[t] * glm::dvec3(target.normal_changes[i]);
  }
}

// Returns the matrix that transforms normals: the transposed inverse times the absolute value of the determinant. This
// factor changes only the length of a normal.
glm::dmat3 normal_matrix(const glm::dmat3& m) {
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::dot(m[0], cofactors[0]) < 0 ? -cofactors : cofactors;
}

void bend(const DeformableMesh& source, std::span<const glm::dmat4> joint_matrices, std::size_t i, Vertex& vertex) {
  glm::dmat3 turn(0);
  glm::dvec3 move(0);
  double sum = 0;
  const JointInfluence* influence = source.influences.data() + i * source.influences_per_vertex;
  for (const JointInfluence* const end = influence + source.influences_per_vertex; influence != end; ++influence) {
    if (influence->weight == 0) continue;
    const glm::dmat4& joint = joint_matrices[influence->joint];
    const double weight = influence->weight;
    for (int column = 0; column < 3; ++column) turn[column] += weight * glm::dvec3(joint[column]);
    move += weight * glm::dvec3(joint[3]);
    sum += weight;
  }
  // Weights sum to one except for rounding. The division removes the rounding error.
  vertex.position = (turn * vertex.position + move) / sum;
  vertex.normal = normal_matrix(turn) * vertex.normal;
}

// Gives each triangle its own vertices and its own normal.
void set_flat_normals(Mesh& mesh) {
  std::vector<glm::vec3> positions;
  std::vector<VertexAttributes> attributes;
  positions.reserve(mesh.indices.size());
  attributes.reserve(mesh.indices.size());
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const std::uint32_t* corner = mesh.indices.data() + i;
    const glm::dvec3 a(mesh.positions[corner[0]]), b(mesh.positions[corner[1]]), c(mesh.positions[corner[2]]);
    const glm::vec3 normal = unit_or(glm::cross(b - a, c - a), VertexAttributes{}.normal);
    for (int k = 0; k < 3; ++k) {
      positions.push_back(mesh.positions[corner[k]]);
      attributes.push_back(mesh.attributes[corner[k]]);
      attributes.back().normal = normal;
    }
  }
  mesh.positions = std::move(positions);
  mesh.attributes = std::move(attributes);
  std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
}

}  // namespace

std::optional<Mesh> deform(const DeformableMesh& source, std::span<const double> weights,
                           std::span<const glm::dmat4> joint_matrices) {
  SIMVIS_ASSERT(weights.empty() || weights.size() == source.targets.size());
  Mesh mesh = source.base;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 base_normal = mesh.attributes[i].normal;
    Vertex vertex{glm::dvec3(mesh.positions[i]), glm::dvec3(base_normal)};
    add_targets(source, weights, i, vertex);
    if (source.influences_per_vertex > 0) bend(source, joint_matrices, i, vertex);
    if (!fits_float(vertex.position)) return std::nullopt;
    mesh.positions[i] = glm::vec3(vertex.position);
    if (vertex.normal != glm::dvec3(base_normal)) mesh.attributes[i].normal = unit_or(vertex.normal, base_normal);
  }
  complete_mesh(mesh, source.flat_normals);
  return mesh;
}

void complete_mesh(Mesh& mesh, bool flat_normals) {
  if (flat_normals) set_flat_normals(mesh);
  compute_bounds(mesh);
}

}  // namespace simvis
