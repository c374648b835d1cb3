#include "engine/draw/round_mesh.h"

#include <cmath>
#include <utility>

#include "engine/base/assert.h"
#include "engine/base/sine_of_degrees.h"
#include "engine/draw/round_texture.h"

namespace simvis {
namespace {

// The largest distance of a vertex from where it belongs, by rounding of its coordinates to float32, for a shape whose
// points are at most `reach_m` away from the origin.
double rounding_of_vertices(double reach_m) { return 0x1p-24 * 1.7320508 * reach_m; }

SineCosine half_side_angle(int sides) { return sine_of_degrees(180.0 / sides); }

// A point of a flat side of a cylinder lies on a chord of its circle.
double deviation_of_circle(int sides) { return 1 - half_side_angle(sides).cos; }

// With weights w of the corners v, a point of a triangle whose corners lie on a sphere has the squared distance
// r^2 - sum w_i w_j |v_i - v_j|^2 from its middle. Two sides are at most as long as c, the chord of an angle of the
// circle, and the diagonal of a quad at most c sqrt(2), by Ptolemy's theorem. The sum is then at most c^2 / 2, in the
// middle of the diagonal.
double deviation_of_sphere(int sides) {
  const double half_chord = half_side_angle(sides).sin;
  return 1 - std::sqrt(1 - 2 * half_chord * half_chord);
}

/// Builds a mesh along z, whatever the axis of the shape.
class RoundMesh {
 public:
  RoundMesh(const ExactSurface& shape, int sides) : shape_(shape), sides_(sides) {}

  Mesh take() {
    switch (shape_.kind) {
      case SurfaceKind::sphere:
        add_sphere();
        break;
      case SurfaceKind::capsule:
        add_capsule();
        break;
      default:
        add_side();
        add_ends();
    }
    return std::move(mesh_);
  }

 private:
  SineCosine side_angle(int side) const { return sine_of_degrees(360.0 * side / sides_); }
  int rows() const { return sides_ / 2; }  // from pole to pole of a sphere
  std::uint32_t in_row() const { return static_cast<std::uint32_t>(sides_) + 1; }

  // `v` in both sets of texture coordinates.
  std::uint32_t add_vertex(const glm::dvec3& position, const glm::dvec3& normal, double u, glm::dvec2 v) {
    mesh_.positions.emplace_back(position);
    VertexAttributes attributes;
    attributes.normal = glm::vec3(normal);
    for (int set = 0; set < 2; ++set) attributes.uv[set] = {u, v[set]};
    mesh_.attributes.push_back(attributes);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }

  // Joins two rows of vertices, of which the lower one begins at `lower` and the upper one at `upper`. The vertices of
  // a row at a tip coincide, so that one triangle of each side would be degenerate there.
  void join_rows(std::uint32_t lower, std::uint32_t upper, bool lower_is_tip, bool upper_is_tip) {
    for (std::uint32_t i = 0; i + 1 < in_row(); ++i) {
      const std::uint32_t a = lower + i, b = a + 1, d = upper + i, c = d + 1;
      if (!lower_is_tip) mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
      if (!upper_is_tip) mesh_.indices.insert(mesh_.indices.end(), {a, c, d});
    }
  }

  // Adds a disc at height `z` that faces up (`up` 1) or down (-1).
  void add_disc(double z, double up) {
    const std::uint32_t middle = add_vertex({0, 0, z}, {0, 0, up}, 0.5, glm::dvec2(0.5));
    for (int i = 0; i < sides_; ++i) {
      const auto [s, c] = side_angle(i);
      add_vertex({shape_.radius_m * c, shape_.radius_m * s, z}, {0, 0, up}, 0.5 + 0.5 * c,
                 {0.5 - 0.5 * up * s, disc_v(s)});
    }
    const auto around = static_cast<std::uint32_t>(sides_);
    for (std::uint32_t i = 0; i < around; ++i) {
      const std::uint32_t here = middle + 1 + i, next = middle + 1 + (i + 1) % around;
      mesh_.indices.insert(mesh_.indices.end(), {middle, up > 0 ? here : next, up > 0 ? next : here});
    }
  }

  // The round side of a cylinder or a cone.
  void add_side() {
    const bool is_cone = shape_.kind == SurfaceKind::cone;
    const double slant = std::hypot(shape_.radius_m, shape_.length_m);
    const double across = is_cone ? shape_.length_m / slant : 1, along = is_cone ? shape_.radius_m / slant : 0;
    for (int row = 0; row < 2; ++row) {
      const double out = is_cone && row == 1 ? 0 : shape_.radius_m;
      for (int i = 0; i <= sides_; ++i) {
        const auto [s, c] = side_angle(i);
        add_vertex({out * c, out * s, (row - 0.5) * shape_.length_m}, {across * c, across * s, along},
                   double(i) / sides_, glm::dvec2(1 - row));
      }
    }
    join_rows(0, in_row(), false, is_cone);
  }

  void add_ends() {
    add_disc(-shape_.length_m / 2, -1);
    if (shape_.kind == SurfaceKind::cylinder) add_disc(shape_.length_m / 2, 1);
  }

  // Adds the vertices of a sphere at one latitude, raised by `rise_m`.
  void add_sphere_row(int row, double rise_m, const glm::dvec2& v) {
    const auto [up, out] = sine_of_degrees(-90 + 180.0 * row / rows());
    for (int i = 0; i <= sides_; ++i) {
      const auto [s, c] = side_angle(i);
      const glm::dvec3 normal{out * c, out * s, up};
      glm::dvec3 position = shape_.radius_m * normal;
      position.z += rise_m;
      add_vertex(position, normal, double(i) / sides_, v);
    }
  }

  void join_sphere_rows(int count) {
    for (int row = 0; row + 1 < count; ++row) {
      const std::uint32_t first = static_cast<std::uint32_t>(row) * in_row();
      join_rows(first, first + in_row(), row == 0, row + 2 == count);
    }
  }

  void add_sphere() {
    for (int row = 0; row <= rows(); ++row) add_sphere_row(row, 0, glm::dvec2(1 - double(row) / rows()));
    join_sphere_rows(rows() + 1);
  }

  // The equator is there twice: at the lower and at the upper end of the cylinder.
  void add_capsule() {
    for (int row = 0; row <= rows() + 1; ++row) {
      const bool upper = row > rows() / 2;
      const int latitude = upper ? row - 1 : row, side = upper ? rows() : 0;
      const double parts = (kCapsuleParts - 1) * latitude + side, from_rim = std::abs(2.0 * latitude / rows() - 1);
      add_sphere_row(latitude, (upper ? 0.5 : -0.5) * shape_.length_m,
                     {1 - parts / (double(kCapsuleParts) * rows()), capsule_end_v(from_rim, upper)});
    }
    join_sphere_rows(rows() + 2);
  }

  const ExactSurface& shape_;
  const int sides_;
  Mesh mesh_;
};

const char* name_of(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::sphere:
      return "sphere";
    case SurfaceKind::cylinder:
      return "cylinder";
    case SurfaceKind::cone:
      return "cone";
    default:
      return "capsule";
  }
}

// The axes of the mesh in cyclic order, the shape's axis last.
void turn_to_axis(Mesh& mesh, int axis) {
  const auto turned = [axis](const glm::vec3& v) {
    glm::vec3 result;
    for (int i = 0; i < 3; ++i) result[(axis + 1 + i) % 3] = v[i];
    return result;
  };
  for (glm::vec3& position : mesh.positions) position = turned(position);
  for (VertexAttributes& attributes : mesh.attributes) attributes.normal = turned(attributes.normal);
}

}  // namespace

Mesh round_mesh(const ExactSurface& shape, int sides) {
  SIMVIS_ASSERT(shape.kind != SurfaceKind::plane && sides >= 8 && sides % 4 == 0);
  Mesh mesh = RoundMesh(shape, sides).take();
  mesh.name = name_of(shape.kind);
  if (shape.axis != 2) turn_to_axis(mesh, shape.axis);
  mesh.surface = shape;
  mesh.surface->deviation_m = deviation_of_round_mesh(shape, deviation_at_radius_1(shape.kind, sides));
  compute_bounds(mesh);
  return mesh;
}

double deviation_at_radius_1(SurfaceKind kind, int sides) {
  const bool has_circle = kind == SurfaceKind::cylinder || kind == SurfaceKind::cone;
  return has_circle ? deviation_of_circle(sides) : deviation_of_sphere(sides);
}

double deviation_of_round_mesh(const ExactSurface& shape, double at_radius_1) {
  return shape.radius_m * at_radius_1 + rounding_of_vertices(shape.radius_m + shape.length_m);
}

}  // namespace simvis
