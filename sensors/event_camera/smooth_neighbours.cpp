#include "sensors/event_camera/smooth_neighbours.h"

#include <algorithm>
#include <cstddef>
#include <glm/glm.hpp>
#include <tuple>

namespace simvis {
namespace {

// Sines of angles between triangles below this are rounding of float32 positions.
constexpr double kSamePlane = 1e-6;

struct Edge {
  std::uint32_t low = 0, high = 0;  // vertices
  std::uint32_t triangle = 0, corner = 0;

  auto key() const { return std::tie(low, high); }
};

std::vector<Edge> sorted_edges(const Mesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(mesh.indices.size());
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const std::uint32_t from = mesh.indices[i], to = mesh.indices[i % 3 == 2 ? i - 2 : i + 1];
    edges.push_back(
        {std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(i / 3), static_cast<std::uint32_t>(i % 3)});
  }
  std::ranges::sort(edges, {},
                    [](const Edge& edge) { return std::tuple(edge.low, edge.high, edge.triangle, edge.corner); });
  return edges;
}

glm::dvec3 normal_of(const Mesh& mesh, std::uint32_t triangle) {
  const auto corner = [&](std::size_t k) {
    return glm::dvec3(mesh.positions[mesh.indices[3 * std::size_t{triangle} + k]]);
  };
  return glm::cross(corner(1) - corner(0), corner(2) - corner(0));
}

bool is_smooth(const Mesh& mesh, const Edge& one, const Edge& other) {
  const auto has_normal = [&](std::uint32_t vertex) {
    return glm::vec3(mesh.attributes[vertex].normal) != glm::vec3(0);
  };
  if (has_normal(one.low) && has_normal(one.high)) return true;
  const glm::dvec3 a = normal_of(mesh, one.triangle), b = normal_of(mesh, other.triangle);
  return glm::dot(a, b) > 0 && glm::length(glm::cross(a, b)) <= kSamePlane * glm::dot(a, b);
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> smooth_neighbours(const Mesh& mesh) {
  std::vector<std::array<std::uint32_t, 3>> neighbours(mesh.indices.size() / 3,
                                                       {kNoNeighbour, kNoNeighbour, kNoNeighbour});
  const std::vector<Edge> edges = sorted_edges(mesh);
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    while (end < edges.size() && edges[end].key() == edges[first].key()) ++end;
    const Edge &one = edges[first], &other = edges[end - 1];
    if (end - first != 2 || one.triangle == other.triangle || !is_smooth(mesh, one, other)) continue;
    neighbours[one.triangle][one.corner] = other.triangle;
    neighbours[other.triangle][other.corner] = one.triangle;
  }
  return neighbours;
}

}  // namespace simvis
