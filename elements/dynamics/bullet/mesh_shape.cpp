#include "elements/dynamics/bullet/mesh_shape.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace simvis {
namespace {

constexpr double kFlatEdge = 1e-4;  // rad: neighbours that are closer than this lie in one plane

using EdgeKey = std::pair<std::array<double, 3>, std::array<double, 3>>;

EdgeKey edge_key(const btVector3& a, const btVector3& b) {
  const std::array<double, 3> from = {a.x(), a.y(), a.z()}, to = {b.x(), b.y(), b.z()};
  return std::minmax(from, to);
}

// From an edge to a third point, perpendicular to the edge; zero for triangles without area.
btVector3 away_from_edge(const btVector3& from, const btVector3& to, const btVector3& third) {
  const btVector3 along = to - from;
  const double length2 = along.length2();
  if (!(length2 > 0)) return {0, 0, 0};
  const btVector3 across = third - from - along * (along.dot(third - from) / length2);
  const double length = across.length();
  return length > 0 ? across / length : btVector3(0, 0, 0);
}

struct EdgeSide {
  std::size_t triangle, edge;
  btVector3 inward;  // from the edge into the triangle
};

// Returns the neighbour that lies most in the plane of the triangle. A triangle that lies on this one, such as its
// other side, is no neighbour.
btVector3 flattest_neighbour(const EdgeSide& side, const std::vector<EdgeSide>& sides) {
  btVector3 flattest(0, 0, 0);
  double most = -1 + kFlatEdge;
  for (const EdgeSide& other : sides) {
    const double flat = -side.inward.dot(other.inward);
    if (other.triangle == side.triangle || flat <= most) continue;
    most = flat;
    flattest = other.inward;
  }
  return flattest;
}

}  // namespace

MeshShape::MeshShape(btStridingMeshInterface* array, std::span<const btVector3> points, std::span<const int> indices)
    : btBvhTriangleMeshShape(array, true), into_neighbours_(indices.size() / 3) {
  std::map<EdgeKey, std::vector<EdgeSide>> edges;
  for (std::size_t t = 0; t < into_neighbours_.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const auto corner = [&](std::size_t k) { return points[static_cast<std::size_t>(indices[3 * t + (e + k) % 3])]; };
      into_neighbours_[t][e].setZero();
      edges[edge_key(corner(0), corner(1))].push_back({t, e, away_from_edge(corner(0), corner(1), corner(2))});
    }
  }
  for (const auto& [key, sides] : edges) {
    for (const EdgeSide& side : sides) {
      into_neighbours_[side.triangle][side.edge] = flattest_neighbour(side, sides);
    }
  }
}

std::optional<btVector3> MeshShape::allowed_normal(const Contact& contact) const {
  const auto& corners = contact.corners;
  btVector3 face = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  const double size2 = face.length();
  if (!(size2 > 0)) return std::nullopt;
  face /= size2;
  const btVector3 towards = contact.overlaps ? contact.body_center - corners[0] : contact.normal;
  if (face.dot(towards) < 0) face = -face;
  // The shortest way out of a deep overlap may lead through the triangle.
  if (contact.overlaps && face.dot(contact.normal) <= 0) return face;
  const double on_edge_m = 1e-6 * (1 + std::sqrt(size2));  // the nearest point is known far better
  for (std::size_t e = 0; e < 3; ++e) {
    const btVector3 inward = away_from_edge(corners[e], corners[(e + 1) % 3], corners[(e + 2) % 3]);
    if (inward.dot(contact.on_mesh - corners[e]) > on_edge_m) continue;
    if (contact.normal.dot(inward) >= -kFlatEdge) continue;  // it does not lean over this edge
    const btVector3& into = into_neighbours_[static_cast<std::size_t>(contact.triangle)][e];
    if (into.isZero()) continue;
    if (face.dot(into) >= -kFlatEdge) return contact.overlaps ? std::optional(face) : std::nullopt;
    if (contact.normal.dot(into) > kFlatEdge) return std::nullopt;
  }
  return contact.normal;
}

}  // namespace simvis
