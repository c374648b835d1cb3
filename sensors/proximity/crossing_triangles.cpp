#include "sensors/proximity/crossing_triangles.h"

#include <algorithm>

namespace simvis {

namespace {

TriangleBox box_of(const Triangle& triangle) {
  TriangleBox box;
  for (const glm::dvec3& corner : triangle) box.add(corner);
  return box;
}

// Six times the signed volume of the tetrahedron.
double volume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d) {
  return glm::dot(b - a, glm::cross(c - a, d - a));
}

bool same_sign(double a, double b, double c) { return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0); }

/// Adds the points where the edges of `edges` pass through `face`.
void add_through(const Triangle& edges, const Triangle& face, Crossings& crossings) {
  const double side[] = {volume(face[0], face[1], face[2], edges[0]), volume(face[0], face[1], face[2], edges[1]),
                         volume(face[0], face[1], face[2], edges[2])};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (!((side[i] < 0 && side[j] > 0) || (side[i] > 0 && side[j] < 0))) continue;
    const glm::dvec3 &from = edges[i], &to = edges[j];
    if (!same_sign(volume(from, to, face[0], face[1]), volume(from, to, face[1], face[2]),
                   volume(from, to, face[2], face[0]))) {
      continue;
    }
    ++crossings.count;
    crossings.sum_m += from + (to - from) * (side[i] / (side[i] - side[j]));
  }
}

}  // namespace

TriangleBox item_box(const DrawList& list, std::uint32_t item, const glm::dmat4& frame_from_world) {
  const DrawItem& drawn = list.items[item];
  const Mesh& mesh = *list.meshes[drawn.mesh];
  const glm::dmat4 frame_from_mesh = frame_from_world * list.world_from_node[drawn.transform];
  TriangleBox box;
  if (mesh.indices.empty()) return box;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at((corner & 1) != 0 ? mesh.bounds_max.x : mesh.bounds_min.x,
                        (corner & 2) != 0 ? mesh.bounds_max.y : mesh.bounds_min.y,
                        (corner & 4) != 0 ? mesh.bounds_max.z : mesh.bounds_min.z);
    box.add(glm::dvec3(frame_from_mesh * glm::dvec4(at, 1)));
  }
  return box;
}

TriangleSet triangles_of(const DrawList& list, std::uint32_t item, const glm::dmat4& frame_from_world,
                         const TriangleBox* near) {
  const DrawItem& drawn = list.items[item];
  const Mesh& mesh = *list.meshes[drawn.mesh];
  TriangleSet set;
  if (mesh.topology != Topology::triangles) return set;
  const glm::dmat4 frame_from_mesh = frame_from_world * list.world_from_node[drawn.transform];
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    Triangle triangle;
    for (std::size_t c = 0; c < 3; ++c) {
      triangle[c] = glm::dvec3(frame_from_mesh * glm::dvec4(glm::dvec3(mesh.positions[mesh.indices[i + c]]), 1));
    }
    const TriangleBox box = box_of(triangle);
    if (near != nullptr && !box.overlaps(*near)) continue;
    set.triangles.push_back(triangle);
    set.box.add(box);
  }
  return set;
}

void add_crossings(const TriangleSet& a, const TriangleSet& b, Crossings& crossings) {
  if (!a.box.overlaps(b.box)) return;
  std::vector<std::pair<const Triangle*, TriangleBox>> near;
  for (const Triangle& theirs : b.triangles) {
    const TriangleBox box = box_of(theirs);
    if (box.overlaps(a.box)) near.emplace_back(&theirs, box);
  }
  for (const Triangle& mine : a.triangles) {
    const TriangleBox box = box_of(mine);
    for (const auto& [theirs, their_box] : near) {
      if (!box.overlaps(their_box)) continue;
      add_through(mine, *theirs, crossings);
      add_through(*theirs, mine, crossings);
    }
  }
}

}  // namespace simvis
