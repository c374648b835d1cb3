// Closed forms of rays and round shapes in quadruple precision, face by face.
#pragma once

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <optional>

#include <simvis/exact_surface.h>

namespace simvis::reference {

__extension__ using Quad = __float128;

struct QuadPoint {
  std::array<Quad, 3> at{};
  Quad& operator[](int i) { return at[static_cast<std::size_t>(i)]; }
  const Quad& operator[](int i) const { return at[static_cast<std::size_t>(i)]; }
};

inline QuadPoint quad(const glm::dvec3& v) { return {{v.x, v.y, v.z}}; }
inline QuadPoint along(const QuadPoint& p, Quad t, const QuadPoint& d) {
  return {{p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]}};
}

inline Quad square_root(Quad square) {
  if (!(square > 0)) return 0;
  Quad root = std::sqrt(static_cast<long double>(square));
  for (int i = 0; i < 2; ++i) root = (root + square / root) / 2;  // Newton; 64 bits to begin with
  return root;
}

/// A ray in the frame of a mesh: range t is that along the unit direction of the sensor frame.
struct MeshRay {
  QuadPoint from, way;
};

/// `world_from_sensor` counts as rigid: its inverse is its transpose.
inline MeshRay ray_in_mesh(const glm::dmat4& world_from_mesh, const glm::dmat4& world_from_sensor,
                           const glm::dvec3& direction) {
  const auto world_of_sensor = [&](const QuadPoint& p) {
    QuadPoint world;
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 3; ++k) world[row] += Quad(world_from_sensor[k][row]) * p[k];
    }
    return world;
  };
  QuadPoint way = world_of_sensor(quad(direction)), from;
  for (int i = 0; i < 3; ++i) from[i] = Quad(world_from_sensor[3][i]) - Quad(world_from_mesh[3][i]);
  std::array<QuadPoint, 3> c;  // columns of the mesh's transform
  for (int k = 0; k < 3; ++k) c[static_cast<std::size_t>(k)] = quad(glm::dvec3(world_from_mesh[k]));
  const auto cross = [](const QuadPoint& a, const QuadPoint& b) {
    return QuadPoint{{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
  };
  const auto dot = [](const QuadPoint& a, const QuadPoint& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const std::array<QuadPoint, 3> rows{cross(c[1], c[2]), cross(c[2], c[0]), cross(c[0], c[1])};
  const Quad determinant = dot(c[0], rows[0]);
  MeshRay ray;
  for (int i = 0; i < 3; ++i) {
    ray.from[i] = dot(rows[static_cast<std::size_t>(i)], from) / determinant;
    ray.way[i] = dot(rows[static_cast<std::size_t>(i)], way) / determinant;
  }
  return ray;
}

struct ShapeHit {
  Quad range_m = std::numeric_limits<double>::infinity();
  std::uint32_t face = kRoundFace;
};

/// The nearest hit beyond `behind_m` of a shape whose axis is z: every root of every face that lies on the face.
class ShapeRay {
 public:
  ShapeRay(const ExactSurface& shape, const MeshRay& ray, Quad behind_m = 0)
      : shape_(shape), ray_(ray), behind_m_(behind_m) {}

  ShapeHit nearest() {
    const Quad half = Quad(shape_.length_m) / 2, radius = shape_.radius_m;
    const auto everywhere = [](const QuadPoint&) { return true; };
    if (shape_.kind == SurfaceKind::sphere) roots(1, 1, 1, 0, radius * radius, everywhere);
    if (shape_.kind == SurfaceKind::cylinder || shape_.kind == SurfaceKind::capsule) {
      roots(1, 1, 0, 0, radius * radius, [&](const QuadPoint& p) { return p[2] >= -half && p[2] <= half; });
    }
    if (shape_.kind == SurfaceKind::capsule) {
      roots(1, 1, 1, half, radius * radius, [&](const QuadPoint& p) { return p[2] >= half; });
      roots(1, 1, 1, -half, radius * radius, [&](const QuadPoint& p) { return p[2] <= -half; });
    }
    if (shape_.kind == SurfaceKind::cone) {
      const Quad ratio = radius / (2 * half);
      // Of a ray through the tip both roots coincide, and rounding may leave both above it.
      const Quad tip = half + Quad(1e-14) * half;
      roots(1, 1, -ratio * ratio, half, 0, [&](const QuadPoint& p) { return p[2] >= -half && p[2] <= tip; });
    }
    const auto on_disc = [&](const QuadPoint& p) { return p[0] * p[0] + p[1] * p[1] <= radius * radius; };
    const bool has_bottom = shape_.kind == SurfaceKind::cylinder || shape_.kind == SurfaceKind::cone;
    if (has_bottom) plane(-half, kBottomFace, on_disc);
    if (shape_.kind == SurfaceKind::cylinder) plane(half, kTopFace, on_disc);
    if (shape_.kind == SurfaceKind::plane) {
      plane(0, kRoundFace, [&](const QuadPoint& p) {
        const auto within = [](Quad value, double limit) { return !(value > limit) && !(-value > limit); };
        return within(p[0], shape_.half_size_m.x) && within(p[1], shape_.half_size_m.y);
      });
    }
    return nearest_;
  }

 private:
  template <class OnFace>
  void plane(Quad z, std::uint32_t face, const OnFace& on_face) {
    if (ray_.way[2] == 0) return;
    const Quad t = (z - ray_.from[2]) / ray_.way[2];
    if (on_face(along(ray_.from, t, ray_.way))) take(t, face);
  }

  // wx x^2 + wy y^2 + wz (z - middle)^2 = square.
  template <class OnFace>
  void roots(Quad wx, Quad wy, Quad wz, Quad middle, Quad square, const OnFace& on_face) {
    const Quad weight[3] = {wx, wy, wz};
    // From the point of the ray that is nearest to the origin, so that no digits are lost to the distance.
    Quad along_way = 0, way_square = 0;
    for (int i = 0; i < 3; ++i) {
      along_way += ray_.from[i] * ray_.way[i];
      way_square += ray_.way[i] * ray_.way[i];
    }
    const Quad nearest = -along_way / way_square;
    const QuadPoint foot = along(ray_.from, nearest, ray_.way);
    Quad a = 0, b = 0, c = -square;
    for (int i = 0; i < 3; ++i) {
      const Quad start = foot[i] - (i == 2 ? middle : Quad(0));
      a += weight[i] * ray_.way[i] * ray_.way[i];
      b += weight[i] * ray_.way[i] * start;
      c += weight[i] * start * start;
    }
    const Quad discriminant = b * b - a * c;
    // A ray that is inside of both halves of a double cone cannot pass it by; rounding may make it so at the tip.
    if ((discriminant < 0 && a > 0) || a == 0) return;
    const Quad root = square_root(discriminant);
    for (const Quad s : {(-b - root) / a, (-b + root) / a}) {
      const Quad t = nearest + s;
      if (on_face(along(ray_.from, t, ray_.way))) take(t, kRoundFace);
    }
  }

  void take(Quad t, std::uint32_t face) {
    if (t > behind_m_ && t < nearest_.range_m) nearest_ = {t, face};
  }

  const ExactSurface& shape_;
  const MeshRay& ray_;
  Quad behind_m_;
  ShapeHit nearest_;
};

/// The nearest hit of an item whose mesh has a shape along z.
inline ShapeHit nearest_hit(const ExactSurface& shape, const glm::dmat4& world_from_mesh,
                            const glm::dmat4& world_from_sensor, const glm::dvec3& direction, Quad behind_m = 0) {
  const MeshRay ray = ray_in_mesh(world_from_mesh, world_from_sensor, direction);
  return ShapeRay(shape, ray, behind_m).nearest();
}

/// The range at which a ray meets a disc around `middle`, perpendicular to `normal`, in the frame of the mesh;
/// infinity: nowhere.
inline Quad range_to_disc(const MeshRay& ray, const glm::dvec3& middle, const glm::dvec3& normal, double radius_m) {
  Quad height = 0, steepness = 0, apart = 0;
  for (int i = 0; i < 3; ++i) {
    height += Quad(normal[i]) * (Quad(middle[i]) - ray.from[i]);
    steepness += Quad(normal[i]) * ray.way[i];
  }
  constexpr double kNowhere = std::numeric_limits<double>::infinity();
  if (steepness == 0 || !(radius_m > 0)) return kNowhere;
  const Quad t = height / steepness;
  const QuadPoint p = along(ray.from, t, ray.way);
  for (int i = 0; i < 3; ++i) apart += (p[i] - Quad(middle[i])) * (p[i] - Quad(middle[i]));
  return t > 0 && apart <= Quad(radius_m) * radius_m ? t : Quad(kNowhere);
}

/// The same shape, larger by a length all around; smaller if it is negative. Empty if nothing is left.
inline std::optional<ExactSurface> grown(ExactSurface shape, double by_m) {
  if (shape.kind == SurfaceKind::plane) {
    shape.half_size_m += by_m;
    return shape;
  }
  // The side of a cone moves by by_m along its normal if its radius and length grow as follows.
  const double slant = std::hypot(shape.radius_m, shape.length_m);
  const bool is_cone = shape.kind == SurfaceKind::cone;
  const double radius_m = shape.radius_m + (is_cone ? by_m * (shape.radius_m + slant) / shape.length_m : by_m);
  if (is_cone) shape.length_m *= radius_m / shape.radius_m;
  if (shape.kind == SurfaceKind::cylinder) shape.length_m += 2 * by_m;
  shape.radius_m = radius_m;
  if (!(shape.radius_m > 0) || (shape.kind != SurfaceKind::sphere && !(shape.length_m > 0))) return {};
  return shape;
}

}  // namespace simvis::reference
