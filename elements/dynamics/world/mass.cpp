#include "elements/dynamics/world/mass.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace simvis {
namespace {

constexpr double kPi = std::numbers::pi;

glm::dmat3 diagonal(double x, double y, double z) { return {{x, 0, 0}, {0, y, 0}, {0, 0, z}}; }

// The inertia of a point mass at `r` about the origin (Steiner).
glm::dmat3 of_point(double mass, const glm::dvec3& r) {
  return mass * (glm::dot(r, r) * glm::dmat3(1.0) - glm::outerProduct(r, r));
}

MassProperties box(const glm::dvec3& half) {
  const double mass = 8 * half.x * half.y * half.z;
  const glm::dvec3 square = half * half;
  return {.mass_kg = mass,
          .center_m = glm::dvec3(0),
          .inertia_kg_m2 = mass / 3 * diagonal(square.y + square.z, square.x + square.z, square.x + square.y)};
}

MassProperties sphere(double r) {
  const double mass = 4 * kPi / 3 * r * r * r, moment = 0.4 * mass * r * r;
  return {.mass_kg = mass, .center_m = glm::dvec3(0), .inertia_kg_m2 = diagonal(moment, moment, moment)};
}

MassProperties cylinder(double r, double half) {
  const double mass = 2 * kPi * r * r * half, across = mass * (r * r / 4 + half * half / 3);
  return {.mass_kg = mass, .center_m = glm::dvec3(0), .inertia_kg_m2 = diagonal(across, across, mass * r * r / 2)};
}

MassProperties capsule(double r, double half) {
  MassProperties all = cylinder(r, half);
  const double mass = 2 * kPi / 3 * r * r * r;  // of one half ball
  // A half ball's centre lies 3/8 r from its flat side; its inertia about that centre follows from that of a ball.
  const double along = 0.4 * mass * r * r, away = 3.0 / 8 * r;
  for (const double side : {-1.0, 1.0}) {
    const MassProperties end{.mass_kg = mass,
                             .center_m = glm::dvec3(0, 0, side * (half + away)),
                             .inertia_kg_m2 = diagonal(along - mass * away * away, along - mass * away * away, along)};
    all = sum_of(all, end);
  }
  return all;
}

// Integrals over the tetrahedra between the origin and each triangle.
MassProperties polyhedron(const CollisionShape& hull) {
  double volume = 0;
  glm::dvec3 first(0);
  glm::dmat3 second(0.0);  // integral of x x^T
  for (std::size_t i = 0; i + 2 < hull.triangles.size(); i += 3) {
    const glm::dvec3 &a = hull.points[hull.triangles[i]], &b = hull.points[hull.triangles[i + 1]],
                     &c = hull.points[hull.triangles[i + 2]], sum = a + b + c;
    const double part = glm::dot(a, glm::cross(b, c)) / 6;
    volume += part;
    first += part / 4 * sum;
    second +=
        part / 20 *
        (glm::outerProduct(a, a) + glm::outerProduct(b, b) + glm::outerProduct(c, c) + glm::outerProduct(sum, sum));
  }
  if (!(volume > 0)) return {};
  const glm::dvec3 center = first / volume;
  const glm::dmat3 about_origin = (second[0][0] + second[1][1] + second[2][2]) * glm::dmat3(1.0) - second;
  return {.mass_kg = volume, .center_m = center, .inertia_kg_m2 = about_origin - of_point(volume, center)};
}

MassProperties unit_density(const CollisionShape& shape) {
  switch (shape.kind) {
    case CollisionKind::box:
      return box(shape.half_m);
    case CollisionKind::sphere:
      return sphere(shape.half_m.x);
    case CollisionKind::capsule:
      return capsule(shape.half_m.x, shape.half_m.z);
    case CollisionKind::cylinder:
      return cylinder(shape.half_m.x, shape.half_m.z);
    case CollisionKind::hull:
      return polyhedron(shape);
    case CollisionKind::mesh:
    case CollisionKind::plane:
      break;
  }
  return {};
}

}  // namespace

MassProperties mass_of(std::span<const CollisionShape> shapes, double density_kg_m3) {
  MassProperties all;
  for (const CollisionShape& shape : shapes) all = sum_of(all, moved(unit_density(shape), shape.body_from_shape));
  return with_mass(all, all.mass_kg * density_kg_m3);
}

MassProperties sum_of(const MassProperties& a, const MassProperties& b) {
  MassProperties all{.mass_kg = a.mass_kg + b.mass_kg, .center_m = a.center_m, .inertia_kg_m2 = glm::dmat3(0.0)};
  if (!(all.mass_kg > 0)) return all;
  all.center_m = (a.mass_kg * a.center_m + b.mass_kg * b.center_m) / all.mass_kg;
  for (const MassProperties* each : {&a, &b}) {
    all.inertia_kg_m2 += each->inertia_kg_m2 + of_point(each->mass_kg, each->center_m - all.center_m);
  }
  return all;
}

MassProperties moved(const MassProperties& mass, const glm::dmat4& parent_from_body) {
  const glm::dmat3 rotation(parent_from_body);
  return {.mass_kg = mass.mass_kg,
          .center_m = glm::dvec3(parent_from_body * glm::dvec4(mass.center_m, 1)),
          .inertia_kg_m2 = rotation * mass.inertia_kg_m2 * glm::transpose(rotation)};
}

MassProperties with_mass(const MassProperties& mass, double mass_kg) {
  if (!(mass.mass_kg > 0)) return mass;
  return {.mass_kg = mass_kg, .center_m = mass.center_m, .inertia_kg_m2 = mass_kg / mass.mass_kg * mass.inertia_kg_m2};
}

// Jacobi's rotations. Twelve sweeps are more than any 3 x 3 matrix of doubles needs.
PrincipalInertia principal_inertia(const glm::dmat3& inertia_kg_m2) {
  constexpr int kSweeps = 12;
  glm::dmat3 a = inertia_kg_m2, axes(1.0);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& [p, q] : {std::pair{0, 1}, {0, 2}, {1, 2}}) {
      const double rounding = std::numeric_limits<double>::epsilon() * std::sqrt(std::abs(a[p][p] * a[q][q]));
      if (std::abs(a[q][p]) <= rounding) continue;
      const double theta = (a[q][q] - a[p][p]) / (2 * a[q][p]);
      const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
      const double c = 1 / std::sqrt(t * t + 1), s = t * c;
      glm::dmat3 turn(1.0);
      turn[p][p] = turn[q][q] = c;
      turn[q][p] = s;
      turn[p][q] = -s;
      a = glm::transpose(turn) * a * turn;
      axes = axes * turn;
    }
  }
  return {axes, {a[0][0], a[1][1], a[2][2]}};
}

glm::dmat3 inertia_of(const PrincipalInertia& inertia) {
  const glm::dvec3& d = inertia.diagonal_kg_m2;
  return inertia.axes * diagonal(d.x, d.y, d.z) * glm::transpose(inertia.axes);
}

bool is_possible(const PrincipalInertia& inertia) {
  // People write inertias with few digits; a flat plate's moments then miss the sum by their rounding.
  constexpr double kRounding = 1e-3;
  const glm::dvec3& d = inertia.diagonal_kg_m2;
  const double sum = d.x + d.y + d.z, largest = std::max({d.x, d.y, d.z});
  return std::isfinite(sum) && std::min({d.x, d.y, d.z}) > 0 && largest <= (sum - largest) * (1 + kRounding);
}

// With the second moments of mass s >= 0 along its axes, a body has the moments d_i = s_j + s_k. So the tensors that
// bodies have are those whose moments obey d_i <= d_j + d_k. Neither this set nor the norm depends on the axes, so the
// nearest tensor keeps the axes (Hoffman and Wielandt), and its moments are the nearest point of a cone with three
// sides: the foot of the perpendicular on a side, or on an edge (0, t, t). The edges contain the apex.
PrincipalInertia nearest_possible(const PrincipalInertia& inertia, double mass_kg) {
  constexpr double kMinRadius_m = 1e-3;
  const glm::dvec3& d = inertia.diagonal_kg_m2;
  glm::dvec3 nearest(0);
  double least = std::numeric_limits<double>::infinity();
  const auto offer = [&](const glm::dvec3& moments) {
    if (const double away = glm::length(moments - d); away < least) {
      least = away;
      nearest = moments;
    }
  };
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    glm::dvec3 edge(0);
    edge[j] = edge[k] = std::max(0.0, (d[j] + d[k]) / 2);
    offer(edge);
    glm::dvec3 normal(-1);
    normal[i] = 1;
    const glm::dvec3 foot = d - std::max(0.0, glm::dot(normal, d)) / 3 * normal;
    if (is_possible({inertia.axes, foot})) offer(foot);
  }
  const double ball = 0.4 * mass_kg * kMinRadius_m * kMinRadius_m;
  if (std::min({nearest.x, nearest.y, nearest.z}) < ball) nearest += ball;
  return {inertia.axes, nearest};
}

}  // namespace simvis
