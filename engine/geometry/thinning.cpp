#include "engine/geometry/thinning.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "engine/geometry/clusters.h"

namespace simvis {
namespace {

/// Sets of vertices that triangles join.
class VertexSets {
 public:
  VertexSets(std::size_t vertices, std::span<const std::uint32_t> indices) : parent_(vertices) {
    std::iota(parent_.begin(), parent_.end(), 0u);
    for (std::size_t i = 0; i < indices.size(); i += 3) {
      join(indices[i], indices[i + 1]);
      join(indices[i], indices[i + 2]);
    }
  }

  /// A vertex that stands for the whole set.
  std::uint32_t of(std::uint32_t vertex) {
    while (parent_[vertex] != vertex) vertex = parent_[vertex] = parent_[parent_[vertex]];
    return vertex;
  }

 private:
  void join(std::uint32_t a, std::uint32_t b) { parent_[of(a)] = of(b); }

  std::vector<std::uint32_t> parent_;
};

}  // namespace

double surface_area(const Mesh& mesh, std::span<const std::uint32_t> indices) {
  double area = 0;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return glm::dvec3(mesh.positions[indices[i + k]]); };
    area += 0.5 * glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
  }
  return area;
}

std::size_t count_parts(std::size_t vertices, std::span<const std::uint32_t> indices) {
  VertexSets sets(vertices, indices);
  std::vector<bool> counted(vertices);
  std::size_t parts = 0;
  for (const std::uint32_t vertex : indices) {
    const std::uint32_t set = sets.of(vertex);
    parts += !counted[set];
    counted[set] = true;
  }
  return parts;
}

std::optional<ThinnedParts> thinned(const Mesh& mesh, std::span<const std::uint32_t> indices) {
  VertexSets sets(mesh.positions.size(), indices);
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  std::uint32_t parts = 0;
  ThinnedParts result;
  Mesh shape;  // order_in_space() reads positions and indices
  shape.positions = mesh.positions;
  shape.indices.assign(indices.begin(), indices.end());
  for (const std::uint32_t triangle : order_in_space(shape)) {
    const std::uint32_t* const corner = &indices[std::size_t{3} * triangle];
    std::uint32_t& part = number[sets.of(corner[0])];
    if (part == kNone) part = parts++;
    if (part % 2 == 0) result.indices.insert(result.indices.end(), corner, corner + 3);
  }
  const double kept_area = surface_area(mesh, result.indices);
  if (parts < kMinThinnedParts || kept_area == 0) return {};
  result.enlarged = std::sqrt(surface_area(mesh, indices) / kept_area);
  return result;
}

std::vector<glm::vec3> enlarged_positions(const Mesh& mesh, std::span<const std::uint32_t> indices, double factor) {
  std::vector<glm::vec3> positions = mesh.positions;
  if (factor == 1) return positions;
  VertexSets sets(positions.size(), indices);
  std::vector<glm::vec3> low(positions.size(), glm::vec3(std::numeric_limits<float>::infinity())), high(low);
  for (glm::vec3& corner : high) corner = -corner;
  for (const std::uint32_t vertex : indices) {
    const std::uint32_t set = sets.of(vertex);
    low[set] = glm::min(low[set], mesh.positions[vertex]);
    high[set] = glm::max(high[set], mesh.positions[vertex]);
  }
  for (const std::uint32_t vertex : indices) {
    const std::uint32_t set = sets.of(vertex);
    const glm::dvec3 middle = 0.5 * (glm::dvec3(low[set]) + glm::dvec3(high[set]));
    positions[vertex] = glm::vec3(middle + factor * (glm::dvec3(mesh.positions[vertex]) - middle));
  }
  return positions;
}

}  // namespace simvis
