#include "elements/dynamics/world/part_shapes.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

#include "engine/base/assert.h"
#include "scenegraph/graph_walk.h"

namespace simvis {
namespace {

std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Points at the same place get the number of the first.
std::vector<std::uint32_t> numbers_of_places(const std::vector<glm::dvec3>& points) {
  std::map<std::array<double, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> numbers(points.size());
  for (std::uint32_t i = 0; i < numbers.size(); ++i) {
    const glm::dvec3& p = points[i];
    numbers[i] = places.try_emplace({p.x, p.y, p.z}, i).first->second;
  }
  return numbers;
}

}  // namespace

Triangles triangles_of(const Group& root) {
  Triangles all;
  walk_graph(root, {.visit = [&](const Node& node, const WalkState& state) {
               if (node.kind() != NodeKind::shape || !state.visible) return;
               const Mesh& mesh = *static_cast<const Shape&>(node).mesh();
               if (mesh.topology != Topology::triangles) return;
               const auto first = static_cast<std::uint32_t>(all.points.size());
               for (const glm::vec3& position : mesh.positions) {
                 all.points.emplace_back(state.world_from_node * glm::dvec4(position, 1));
               }
               for (const std::uint32_t index : mesh.indices) all.indices.push_back(first + index);
             }});
  return all;
}

CollisionShape fitted(CollisionKind kind, const Triangles& triangles) {
  SIMVIS_ASSERT(!triangles.indices.empty());
  glm::dvec3 low = triangles.points[triangles.indices[0]], high = low;
  for (const std::uint32_t index : triangles.indices) {
    low = glm::min(low, triangles.points[index]);
    high = glm::max(high, triangles.points[index]);
  }
  const glm::dvec3 half = (high - low) / 2.0;
  CollisionShape shape{.kind = kind, .half_m = half};
  shape.body_from_shape[3] = glm::dvec4((low + high) / 2.0, 1);
  if (kind == CollisionKind::box) return shape;
  const double radius = kind == CollisionKind::sphere ? std::max({half.x, half.y, half.z}) : std::max(half.x, half.y);
  const double straight = kind == CollisionKind::capsule ? std::max(half.z - radius, 0.0) : half.z;
  shape.half_m = {radius, radius, straight};
  return shape;
}

CollisionShape mesh_of(const Triangles& triangles) {
  return {.kind = CollisionKind::mesh, .points = triangles.points, .triangles = triangles.indices};
}

bool is_closed(const Triangles& triangles) {
  const std::vector<std::uint32_t> number = numbers_of_places(triangles.points);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> surplus;  // of an edge's triangles from its lower number on
  for (std::size_t i = 0; i + 2 < triangles.indices.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = number[triangles.indices[i + k]], to = number[triangles.indices[i + (k + 1) % 3]];
      surplus[std::minmax(from, to)] += from < to ? 1 : to < from ? -1 : 0;
    }
  }
  return std::ranges::all_of(surplus, [](const auto& edge) { return edge.second == 0; });
}

std::vector<Triangles> connected_pieces(const Triangles& triangles) {
  std::vector<std::uint32_t> parent = numbers_of_places(triangles.points);
  for (std::size_t i = 0; i + 2 < triangles.indices.size(); i += 3) {
    const std::uint32_t first = root_of(parent, triangles.indices[i]);
    for (const std::size_t other : {i + 1, i + 2}) parent[root_of(parent, triangles.indices[other])] = first;
  }
  std::map<std::uint32_t, std::size_t> pieces;  // by root, in the order of the first triangle
  std::vector<Triangles> result;
  for (std::size_t i = 0; i + 2 < triangles.indices.size(); i += 3) {
    const auto [piece, is_new] = pieces.try_emplace(root_of(parent, triangles.indices[i]), result.size());
    if (is_new) result.emplace_back();
    Triangles& own = result[piece->second];
    for (std::size_t corner = i; corner < i + 3; ++corner) {
      own.indices.push_back(static_cast<std::uint32_t>(own.points.size()));
      own.points.push_back(triangles.points[triangles.indices[corner]]);
    }
  }
  return result;
}

}  // namespace simvis
