#include "elements/visualization/marker_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace simvis {
namespace {

constexpr std::uint32_t kLineSides = 3, kConeSides = 12, kPointFaces = 8;

// Size of an arrow's head as multiples of its line width.
constexpr double kHeadLength = 5, kHeadRadius = 1.6;

glm::vec3 rounded(const glm::dvec3& v) { return {v}; }

// Returns a unit vector perpendicular to a unit vector: the horizontal one to the left, unless `axis` is nearly
// vertical.
glm::dvec3 square_to(const glm::dvec3& axis) {
  const glm::dvec3 other = std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  return glm::normalize(glm::cross(other, axis));
}

}  // namespace

std::uint32_t MarkerMesh::add_vertex(const glm::dvec3& position, const glm::vec4& color) {
  mesh_.positions.push_back(rounded(position));
  mesh_.attributes.push_back({.color = color});
  return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

void MarkerMesh::add_point(const glm::dvec3& center, double size_m, const glm::vec4& color) {
  if (size_m == 0) return;
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 half{0};
    half[axis] = size_m / 2;
    add_vertex(center + half, color);
    add_vertex(center - half, color);
  }
  // One face per octant, with corners on +x or -x, +y or -y, +z or -z. This order is counter-clockwise from outside if
  // an even number of them is negative.
  for (std::uint32_t octant = 0; octant < kPointFaces; ++octant) {
    const std::uint32_t x = octant & 1, y = octant >> 1 & 1, z = octant >> 2;
    const bool even = (x + y + z) % 2 == 0;
    const std::uint32_t on_x = first + x, on_y = first + 2 + y, on_z = first + 4 + z;
    mesh_.indices.insert(mesh_.indices.end(), {on_x, even ? on_y : on_z, even ? on_z : on_y});
  }
}

// Adds corners around `axis`, a unit vector, counter-clockwise as seen from its tip. Returns the index of the first
// corner.
std::uint32_t MarkerMesh::add_ring(const glm::dvec3& center, const glm::dvec3& axis, double radius_m,
                                   std::uint32_t corners, const glm::vec4& color) {
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  const glm::dvec3 u = square_to(axis), v = glm::cross(axis, u);
  for (std::uint32_t i = 0; i < corners; ++i) {
    // The first corner of a horizontal line is its upper one.
    const double turn = std::numbers::pi * (0.5 + 2.0 * i / corners);
    add_vertex(center + radius_m * (std::cos(turn) * u + std::sin(turn) * v), color);
  }
  return first;
}

// Closes a ring. `front`: the cap is visible from the tip of the ring's axis, otherwise from the other side.
void MarkerMesh::add_cap(std::uint32_t ring, std::uint32_t corners, bool front) {
  for (std::uint32_t i = 1; i + 1 < corners; ++i) {
    mesh_.indices.insert(mesh_.indices.end(), {ring, ring + (front ? i : i + 1), ring + (front ? i + 1 : i)});
  }
}

void MarkerMesh::add_line(const glm::dvec3& from, const glm::dvec3& to, double width_m, const glm::vec4& color) {
  if (width_m == 0 || from == to) return;
  const glm::dvec3 axis = glm::normalize(to - from);
  const double radius_m = width_m / std::numbers::sqrt3;  // circumradius of a triangle with sides of width_m
  const std::uint32_t start = add_ring(from, axis, radius_m, kLineSides, color);
  const std::uint32_t end = add_ring(to, axis, radius_m, kLineSides, color);
  for (std::uint32_t i = 0; i < kLineSides; ++i) {
    const std::uint32_t next = (i + 1) % kLineSides;
    mesh_.indices.insert(mesh_.indices.end(), {start + i, start + next, end + next, start + i, end + next, end + i});
  }
  add_cap(start, kLineSides, false);
  add_cap(end, kLineSides, true);
}

void MarkerMesh::add_cone(const glm::dvec3& base, const glm::dvec3& tip, double radius_m, const glm::vec4& color) {
  const glm::dvec3 axis = glm::normalize(tip - base);
  const std::uint32_t ring = add_ring(base, axis, radius_m, kConeSides, color);
  const std::uint32_t top = add_vertex(tip, color);
  for (std::uint32_t i = 0; i < kConeSides; ++i) {
    mesh_.indices.insert(mesh_.indices.end(), {ring + i, ring + (i + 1) % kConeSides, top});
  }
  add_cap(ring, kConeSides, false);
}

void MarkerMesh::add_arrow(const glm::dvec3& from, const glm::dvec3& to, double width_m, const glm::vec4& color) {
  if (width_m == 0 || from == to) return;
  const double length_m = glm::length(to - from);
  const double head_m = std::min(kHeadLength * width_m, length_m / 2);
  const glm::dvec3 neck = to - head_m / length_m * (to - from);
  add_line(from, neck, width_m, color);
  add_cone(neck, to, kHeadRadius * width_m, color);
}

std::shared_ptr<const Mesh> MarkerMesh::take(const std::string& name) {
  auto mesh = std::make_shared<Mesh>(std::exchange(mesh_, {}));
  mesh->name = name;
  mesh->short_lived = true;
  compute_bounds(*mesh);
  return mesh;
}

std::shared_ptr<const Material> marker_material(AlphaMode mode) {
  auto material = std::make_shared<Material>();
  material->name = "marker";
  material->alpha_mode = mode;
  material->unlit = true;
  return material;
}

MarkerNodes make_marker_nodes(const std::string& name) {
  MarkerNodes nodes{.separator = std::make_shared<VisualSeparator>(),
                    .material = std::make_shared<MaterialNode>(marker_material(AlphaMode::opaque)),
                    .place = std::make_shared<Transform>(),
                    .shape = std::make_shared<Shape>(MarkerMesh().take(name))};
  nodes.separator->name = name;
  nodes.separator->add(nodes.material);
  nodes.separator->add(nodes.place);
  nodes.separator->add(nodes.shape);
  return nodes;
}

}  // namespace simvis
