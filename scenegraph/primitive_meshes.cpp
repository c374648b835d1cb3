#include "scenegraph/primitive_meshes.h"

#include <cmath>
#include <utility>

namespace simvis {
namespace {

std::uint32_t add_vertex(Mesh& mesh, const glm::dvec3& position, const glm::dvec3& normal, double u, double v) {
  mesh.positions.emplace_back(position);
  VertexAttributes attributes;
  attributes.normal = glm::vec3(normal);
  attributes.uv[0] = attributes.uv[1] = {u, v};
  mesh.attributes.push_back(attributes);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

}  // namespace

Mesh box_mesh(const glm::dvec3& size_m) {
  Mesh mesh;
  mesh.name = "box";
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 normal{0};
      normal[axis] = side;
      // Of a picture, seen from outside.
      const glm::dvec3 up = axis < 2 ? glm::dvec3(0, 0, 1) : side > 0 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
      const glm::dvec3 right = glm::cross(up, normal);
      const int first_axis = (axis + (side > 0 ? 1 : 2)) % 3, second_axis = (axis + (side > 0 ? 2 : 1)) % 3;
      std::uint32_t first = 0;
      for (const auto& [first_share, second_share] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        glm::dvec3 share = normal / 2.0;
        share[first_axis] = first_share - 0.5;
        share[second_axis] = second_share - 0.5;
        first = add_vertex(mesh, share * size_m, normal, 0.5 + glm::dot(share, right), 0.5 - glm::dot(share, up)) - 3;
      }
      mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
    }
  }
  compute_bounds(mesh);
  return mesh;
}

glm::dmat4 exact_box_scale(const glm::dvec3& size_m) {
  glm::dmat4 scale(1);
  for (int i = 0; i < 3; ++i) {
    const auto rounded_m = static_cast<double>(static_cast<float>(size_m[i] / 2));
    // Sizes that no float has stay as the mesh has them: files of strangers may say 1e-60.
    if (rounded_m > 0 && std::isfinite(rounded_m)) scale[i][i] = size_m[i] / 2 / rounded_m;
  }
  return scale;
}

Mesh cylinder_mesh(double radius_m, double length_m) {
  return round_mesh({.kind = SurfaceKind::cylinder, .radius_m = radius_m, .length_m = length_m}, kSidesAround);
}

Mesh cone_mesh(double radius_m, double length_m) {
  return round_mesh({.kind = SurfaceKind::cone, .radius_m = radius_m, .length_m = length_m}, kSidesAround);
}

Mesh sphere_mesh(double radius_m) {
  return round_mesh({.kind = SurfaceKind::sphere, .radius_m = radius_m}, kSidesAround);
}

Mesh capsule_mesh(double radius_m, double length_m) {
  return round_mesh({.kind = SurfaceKind::capsule, .radius_m = radius_m, .length_m = length_m}, kSidesAround);
}

Mesh plane_mesh(const glm::dvec2& size_m) {
  Mesh mesh;
  mesh.name = "plane";
  for (const auto& [u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
    add_vertex(mesh, {(u - 0.5) * size_m.x, (v - 0.5) * size_m.y, 0}, {0, 0, 1}, u, 1 - v);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  compute_bounds(mesh);
  return mesh;
}

Mesh endless_plane_mesh(const glm::dvec2& half_size_m) {
  const bool ends_x = std::isfinite(half_size_m.x), ends_y = std::isfinite(half_size_m.y);
  const glm::dvec2 drawn_m(ends_x ? 2 * half_size_m.x : kDrawnPlane_m, ends_y ? 2 * half_size_m.y : kDrawnPlane_m);
  Mesh mesh = plane_mesh(drawn_m);
  if (ends_x && ends_y) return mesh;
  mesh.surface = ExactSurface{.kind = SurfaceKind::plane, .half_size_m = half_size_m, .drawn_m = drawn_m};
  return mesh;
}

}  // namespace simvis
