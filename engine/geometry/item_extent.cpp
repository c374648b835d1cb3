#include "engine/geometry/item_extent.h"

#include <algorithm>
#include <cmath>

#include "engine/geometry/round_levels.h"

namespace simvis {

namespace {

double farthest_corner(const Mesh& mesh) {
  return glm::length(glm::max(glm::abs(glm::dvec3(mesh.bounds_min)), glm::abs(glm::dvec3(mesh.bounds_max))));
}

}  // namespace

ItemExtent extent_of(const Mesh& mesh, const glm::dmat4& world_from_mesh) {
  const double scale = stretch_of(glm::dmat3(world_from_mesh));
  const glm::dvec3 half = 0.5 * (glm::dvec3(mesh.bounds_max) - glm::dvec3(mesh.bounds_min));
  ItemExtent extent;
  extent.reach_m = scale * farthest_corner(mesh);
  extent.radius_m = scale * glm::length(half);
  // The edges of a round shape are those of the level that is drawn, see round_levels.h.
  const bool has_known_edges = mesh.longest_edge > 0 && !has_round_levels(mesh);
  extent.edge_m = has_known_edges ? scale * mesh.longest_edge : 2 * extent.radius_m;
  extent.away_m = glm::length(glm::dvec3(world_from_mesh[3]));
  return extent;
}

ItemExtent longest(const ItemExtent& a, const ItemExtent& b) {
  return {std::max(a.reach_m, b.reach_m), std::max(a.radius_m, b.radius_m), std::max(a.edge_m, b.edge_m),
          std::max(a.away_m, b.away_m)};
}

double stretch_of(const glm::dmat3& m) {
  const glm::dvec3 length = lengths_of(m);
  return is_orthogonal(m) ? std::max({length.x, length.y, length.z}) * (1 + 2 * kOrthogonal) : glm::length(length);
}

glm::dvec3 lengths_of(const glm::dmat3& m) { return {glm::length(m[0]), glm::length(m[1]), glm::length(m[2])}; }

bool is_orthogonal(const glm::dmat3& m) {
  const glm::dvec3 length = lengths_of(m);
  return std::abs(glm::dot(m[0], m[1])) <= kOrthogonal * length.x * length.y &&
         std::abs(glm::dot(m[1], m[2])) <= kOrthogonal * length.y * length.z &&
         std::abs(glm::dot(m[2], m[0])) <= kOrthogonal * length.z * length.x;
}

}  // namespace simvis
