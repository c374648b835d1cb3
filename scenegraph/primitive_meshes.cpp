#include "scenegraph/primitive_meshes.h"

#include <cmath>
#include <utility>

#include <simvis/pose.h>
#include "engine/draw/capsule_texture.h"

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

SinCos side_angle(int side) { return sincos_deg(360.0 * side / kSidesAround); }
SinCos half_side_angle() { return sincos_deg(180.0 / kSidesAround); }

// The largest distance of a vertex from where it belongs, by rounding of its coordinates to float32, for a shape whose
// points are at most `reach_m` away from the origin.
double rounding_of_vertices(double reach_m) { return 0x1p-24 * 1.7320508 * reach_m; }

// A point of a flat side of a cylinder lies on a chord of its circle.
double deviation_of_circle(double radius_m) { return radius_m * (1 - half_side_angle().cos); }

// With weights w of the corners v, a point of a triangle whose corners lie on a sphere has the squared distance
// r^2 - sum w_i w_j |v_i - v_j|^2 from its middle. Two sides are at most as long as c, the chord of an angle of the
// circle, and the diagonal of a quad at most c sqrt(2), by Ptolemy's theorem. The sum is then at most c^2 / 2, in the
// middle of the diagonal.
double deviation_of_sphere(double radius_m) {
  const double half_chord = half_side_angle().sin;
  return radius_m * (1 - std::sqrt(1 - 2 * half_chord * half_chord));
}

ExactSurface round_surface(SurfaceKind kind, double radius_m, double length_m) {
  const bool has_circle = kind == SurfaceKind::cylinder || kind == SurfaceKind::cone;
  return {.kind = kind,
          .radius_m = radius_m,
          .length_m = length_m,
          .deviation_m = (has_circle ? deviation_of_circle(radius_m) : deviation_of_sphere(radius_m)) +
                         rounding_of_vertices(radius_m + length_m)};
}

// Joins two rows of kSidesAround + 1 vertices, of which the lower one begins at `lower` and the upper one at `upper`.
// The vertices of a row at a tip coincide, so that one triangle of each side would be degenerate there.
void join_rows(Mesh& mesh, std::uint32_t lower, std::uint32_t upper, bool lower_is_tip, bool upper_is_tip) {
  for (std::uint32_t i = 0; i < kSidesAround; ++i) {
    const std::uint32_t a = lower + i, b = a + 1, d = upper + i, c = d + 1;
    if (!lower_is_tip) mesh.indices.insert(mesh.indices.end(), {a, b, c});
    if (!upper_is_tip) mesh.indices.insert(mesh.indices.end(), {a, c, d});
  }
}

// Adds a disc at height `z` that faces up (`up` 1) or down (-1).
void add_disc(Mesh& mesh, double radius_m, double z, double up) {
  const std::uint32_t middle = add_vertex(mesh, {0, 0, z}, {0, 0, up}, 0.5, 0.5);
  for (int i = 0; i < kSidesAround; ++i) {
    const auto [s, c] = side_angle(i);
    add_vertex(mesh, {radius_m * c, radius_m * s, z}, {0, 0, up}, 0.5 + 0.5 * c, 0.5 - 0.5 * up * s);
  }
  for (std::uint32_t i = 0; i < kSidesAround; ++i) {
    const std::uint32_t here = middle + 1 + i, next = middle + 1 + (i + 1) % kSidesAround;
    mesh.indices.insert(mesh.indices.end(), {middle, up > 0 ? here : next, up > 0 ? next : here});
  }
}

constexpr int kRows = kSidesAround / 2;  // from pole to pole of a sphere
constexpr std::uint32_t kInRow = kSidesAround + 1;

// Adds the vertices of a sphere at one latitude, raised by `rise_m`.
void add_sphere_row(Mesh& mesh, double radius_m, int row, double rise_m, double v) {
  const auto [up, out] = sincos_deg(-90 + 180.0 * row / kRows);
  for (int i = 0; i <= kSidesAround; ++i) {
    const auto [s, c] = side_angle(i);
    const glm::dvec3 normal{out * c, out * s, up};
    glm::dvec3 position = radius_m * normal;
    position.z += rise_m;
    add_vertex(mesh, position, normal, double(i) / kSidesAround, v);
  }
}

}  // namespace

Mesh box_mesh(const glm::dvec3& size_m) {
  Mesh mesh;
  mesh.name = "box";
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      // The axes u, v and the normal are right-handed.
      const int u_axis = (axis + (side > 0 ? 1 : 2)) % 3, v_axis = (axis + (side > 0 ? 2 : 1)) % 3;
      std::uint32_t first = 0;
      for (const auto& [u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        glm::dvec3 position{0}, normal{0};
        normal[axis] = side;
        position[axis] = side * size_m[axis] / 2;
        position[u_axis] = (u - 0.5) * size_m[u_axis];
        position[v_axis] = (v - 0.5) * size_m[v_axis];
        first = add_vertex(mesh, position, normal, u, 1 - v) - 3;
      }
      mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
    }
  }
  compute_bounds(mesh);
  return mesh;
}

Mesh cylinder_mesh(double radius_m, double length_m) {
  Mesh mesh;
  mesh.name = "cylinder";
  std::uint32_t rows[2] = {0, 0};
  for (int row = 0; row < 2; ++row) {
    rows[row] = static_cast<std::uint32_t>(mesh.positions.size());
    for (int i = 0; i <= kSidesAround; ++i) {
      const auto [s, c] = side_angle(i);
      add_vertex(mesh, {radius_m * c, radius_m * s, (row - 0.5) * length_m}, {c, s, 0}, double(i) / kSidesAround,
                 1 - row);
    }
  }
  join_rows(mesh, rows[0], rows[1], false, false);
  add_disc(mesh, radius_m, -length_m / 2, -1);
  add_disc(mesh, radius_m, length_m / 2, 1);
  mesh.surface = round_surface(SurfaceKind::cylinder, radius_m, length_m);
  compute_bounds(mesh);
  return mesh;
}

Mesh cone_mesh(double radius_m, double length_m) {
  Mesh mesh;
  mesh.name = "cone";
  const double slant = std::hypot(radius_m, length_m);
  for (int row = 0; row < 2; ++row) {
    for (int i = 0; i <= kSidesAround; ++i) {
      const auto [s, c] = side_angle(i);
      const double out = row == 0 ? radius_m : 0;
      add_vertex(mesh, {out * c, out * s, (row - 0.5) * length_m},
                 {length_m / slant * c, length_m / slant * s, radius_m / slant}, double(i) / kSidesAround, 1 - row);
    }
  }
  join_rows(mesh, 0, kSidesAround + 1, false, true);
  add_disc(mesh, radius_m, -length_m / 2, -1);
  mesh.surface = round_surface(SurfaceKind::cone, radius_m, length_m);
  compute_bounds(mesh);
  return mesh;
}

Mesh sphere_mesh(double radius_m) {
  Mesh mesh;
  mesh.name = "sphere";
  for (int row = 0; row <= kRows; ++row) add_sphere_row(mesh, radius_m, row, 0, 1 - double(row) / kRows);
  for (std::uint32_t row = 0; row < kRows; ++row) {
    join_rows(mesh, row * kInRow, (row + 1) * kInRow, row == 0, row + 1 == kRows);
  }
  mesh.surface = round_surface(SurfaceKind::sphere, radius_m, 0);
  compute_bounds(mesh);
  return mesh;
}

Mesh capsule_mesh(double radius_m, double length_m) {
  Mesh mesh;
  mesh.name = "capsule";
  static_assert(kCapsuleSideShare == 1.0 / (kRows + 1));
  // The equator is there twice: at the lower and at the upper end of the cylinder.
  for (int row = 0; row <= kRows + 1; ++row) {
    const bool upper = row > kRows / 2;
    add_sphere_row(mesh, radius_m, upper ? row - 1 : row, (upper ? 0.5 : -0.5) * length_m,
                   1 - double(row) / (kRows + 1));
  }
  for (std::uint32_t row = 0; row <= kRows; ++row) {
    join_rows(mesh, row * kInRow, (row + 1) * kInRow, row == 0, row == kRows);
  }
  mesh.surface = round_surface(SurfaceKind::capsule, radius_m, length_m);
  compute_bounds(mesh);
  return mesh;
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
