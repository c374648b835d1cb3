#include "program/maps/cell_overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace simvis {
namespace {

using Corners = std::array<glm::dvec3, 8>;

CellBox grown(const CellBox& box, double by) { return {box.low - by, box.high + by}; }

bool is_empty(const CellBox& box) { return glm::any(glm::lessThanEqual(box.high, box.low)); }

glm::dvec3 corner_of(const CellBox& box, unsigned i) {
  return {(i & 1) != 0 ? box.high.x : box.low.x, (i & 2) != 0 ? box.high.y : box.low.y,
          (i & 4) != 0 ? box.high.z : box.low.z};
}

// The edges of a box, as pairs of corners that differ in one bit.
template <typename Action>
void for_each_edge(const Action& action) {
  for (unsigned i = 0; i < 8; ++i) {
    for (const unsigned bit : {1u, 2u, 4u}) {
      if ((i & bit) == 0) action(i, i | bit);
    }
  }
}

// Whether a box around the origin lies on one side of all corners along the axis, or touches them.
bool separates(const glm::dvec3& axis, const std::array<glm::dvec3, 3>& corners, const glm::dvec3& half) {
  const double a = glm::dot(axis, corners[0]), b = glm::dot(axis, corners[1]), c = glm::dot(axis, corners[2]);
  const double reach = glm::dot(glm::abs(axis), half);
  return std::min({a, b, c}) >= reach || std::max({a, b, c}) <= -reach;
}

// The convex hull of points of a plane, and of points at infinity in some directions.
struct Polygon {
  std::vector<glm::dvec2> points, directions;
};

double distance_to_segment(const glm::dvec2& from, const glm::dvec2& way, double longest) {
  const double length2 = glm::dot(way, way);
  const double t = length2 > 0 ? std::clamp(-glm::dot(from, way) / length2, 0.0, longest) : 0;
  return glm::length(from + t * way);
}

// Whether the polygon is around the origin: the directions to its points leave no gap of half a turn.
bool is_around_origin(const Polygon& polygon) {
  std::vector<double> angles;
  for (const glm::dvec2& point : polygon.points) angles.push_back(std::atan2(point.y, point.x));
  for (const glm::dvec2& direction : polygon.directions) angles.push_back(std::atan2(direction.y, direction.x));
  if (angles.empty()) return false;
  std::ranges::sort(angles);
  double gap = angles.front() + 2 * std::numbers::pi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap < std::numbers::pi;
}

// Whether a point of the polygon is nearer to the origin than `radius`.
bool comes_within(const Polygon& polygon, double radius) {
  const double unbounded = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.points.size(); ++i) {
    const glm::dvec2& point = polygon.points[i];
    for (std::size_t k = i; k < polygon.points.size(); ++k) {
      if (distance_to_segment(point, polygon.points[k] - point, 1) < radius) return true;
    }
    for (const glm::dvec2& direction : polygon.directions) {
      if (distance_to_segment(point, direction, unbounded) < radius) return true;
    }
  }
  return is_around_origin(polygon);
}

glm::dvec3 in_shape_frame(const CellSolid& solid, const glm::dvec3& cell) {
  return solid.shape_from_cells * cell + solid.offset;
}

Corners corners_in_shape_frame(const CellSolid& solid, const CellBox& box) {
  Corners corners;
  for (unsigned i = 0; i < 8; ++i) corners[i] = in_shape_frame(solid, corner_of(box, i));
  return corners;
}

// The radius of a cylinder or a cone at a height, for a length of 1 around the axis.
double width_at(const CellSolid& solid, double z) {
  return solid.kind == SurfaceKind::cone ? (solid.half_length - z) / (2 * solid.half_length) : 1;
}

bool is_inside(const CellSolid& solid, const glm::dvec3& p) {
  switch (solid.kind) {
    case SurfaceKind::sphere:
      return glm::length(p) < solid.radius;
    case SurfaceKind::capsule:
      return glm::length(p - glm::dvec3(0, 0, std::clamp(p.z, -solid.half_length, solid.half_length))) < solid.radius;
    default:
      return std::abs(p.z) < solid.half_length && glm::length(glm::dvec2(p)) < solid.radius * width_at(solid, p.z);
  }
}

// The box between the planes at both ends of a cylinder or a cone, seen along the axis: from the tip of the cone, or
// from infinity. A point at the height of the tip is seen at infinity.
Polygon seen_along_axis(const CellSolid& solid, const Corners& corners) {
  Polygon polygon;
  const auto add = [&](const glm::dvec3& point) {
    const double width = width_at(solid, point.z);
    const glm::dvec2 across(point);
    if (width > 0) {
      polygon.points.push_back(across / width);
    } else if (across != glm::dvec2(0)) {
      polygon.directions.push_back(across);
    }
  };
  for (const glm::dvec3& corner : corners) {
    if (std::abs(corner.z) <= solid.half_length) add(corner);
  }
  for_each_edge([&](unsigned i, unsigned k) {
    const glm::dvec3 &a = corners[i], &b = corners[k];
    for (const double end : {-solid.half_length, solid.half_length}) {
      if ((a.z < end) == (b.z < end)) continue;
      glm::dvec3 point = a + (end - a.z) / (b.z - a.z) * (b - a);
      point.z = end;
      add(point);
    }
  });
  return polygon;
}

// The squared length of the shortest centre + sum t_i ways[i] with t_i from -1 to 1. Of the t_i, those in `free` lie
// between these limits; the others are given by `center`. Infinity if there is no single such point.
double shortest_of_free(const glm::dvec3& center, std::span<const glm::dvec3> free) {
  const std::size_t n = free.size();
  glm::dmat3 matrix(1.0);
  glm::dvec3 right(0);
  for (std::size_t i = 0; i < n; ++i) {
    right[static_cast<int>(i)] = -glm::dot(free[i], center);
    for (std::size_t k = 0; k < n; ++k) matrix[static_cast<int>(k)][static_cast<int>(i)] = glm::dot(free[i], free[k]);
  }
  const double determinant = glm::determinant(matrix);
  if (determinant == 0) return std::numeric_limits<double>::infinity();
  const glm::dvec3 t = glm::inverse(matrix) * right;
  glm::dvec3 point = center;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(std::abs(t[static_cast<int>(i)]) <= 1)) return std::numeric_limits<double>::infinity();
    point += t[static_cast<int>(i)] * free[i];
  }
  return glm::dot(point, point);
}

// The length of the shortest center + sum t_i ways[i] with t_i from -1 to 1, of up to four ways. Its t_i are at a limit
// or free, and among these cases is the shortest: at most three are free, since more would depend on each other.
double shortest(const glm::dvec3& center, std::span<const glm::dvec3> ways) {
  unsigned cases = 1;
  for (std::size_t i = 0; i < ways.size(); ++i) cases *= 3;
  double least = std::numeric_limits<double>::infinity();
  for (unsigned number = 0; number < cases; ++number) {
    glm::dvec3 at = center;
    std::array<glm::dvec3, 3> free;
    std::size_t count = 0, all_free = 0;
    unsigned rest = number;
    for (const glm::dvec3& way : ways) {
      const unsigned state = rest % 3;
      rest /= 3;
      if (state == 2 && count < free.size()) {
        free[count++] = way;
      } else {
        at += (state == 0 ? -1.0 : 1.0) * way;
      }
      all_free += state == 2 ? 1 : 0;
    }
    if (all_free > free.size()) continue;
    least = std::min(least, shortest_of_free(at, {free.data(), count}));
  }
  return std::sqrt(least);
}

// Whether a part of the open box is inside of the solid.
bool reaches_inside(const CellSolid& solid, const CellBox& box) {
  const Corners corners = corners_in_shape_frame(solid, box);
  if (std::ranges::any_of(corners, [&](const glm::dvec3& corner) { return is_inside(solid, corner); })) return true;
  if (solid.kind == SurfaceKind::sphere || solid.kind == SurfaceKind::capsule) {
    const glm::dvec3 half = 0.5 * (box.high - box.low);
    const std::array ways = {solid.shape_from_cells[0] * half.x, solid.shape_from_cells[1] * half.y,
                             solid.shape_from_cells[2] * half.z, glm::dvec3(0, 0, solid.half_length)};
    const std::size_t count = solid.kind == SurfaceKind::sphere ? 3 : 4;
    return shortest(in_shape_frame(solid, 0.5 * (box.low + box.high)), std::span(ways).first(count)) < solid.radius;
  }
  const auto [low, high] = std::ranges::minmax(corners, {}, &glm::dvec3::z);
  if (low.z >= solid.half_length || high.z <= -solid.half_length) return false;
  return comes_within(seen_along_axis(solid, corners), solid.radius);
}

}  // namespace

std::optional<CellTriangle> settle(CellTriangle triangle) {
  auto& [a, b, c] = triangle.corners;
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  if (normal == glm::dvec3(0)) return std::nullopt;
  for (int axis = 0; axis < 3; ++axis) {
    const double boundary = std::round(a[axis]), near = triangle.rounding[axis];
    const bool is_in_boundary = std::ranges::all_of(
        triangle.corners, [&](const glm::dvec3& corner) { return std::abs(corner[axis] - boundary) <= near; });
    if (!is_in_boundary) continue;
    const double behind = boundary + (normal[axis] > 0 ? -0.5 : 0.5);
    a[axis] = b[axis] = c[axis] = behind;
    break;
  }
  return triangle;
}

bool overlaps(const CellTriangle& triangle, const CellBox& box) {
  const CellBox inner{box.low + triangle.rounding, box.high - triangle.rounding};
  if (is_empty(inner)) return false;
  const glm::dvec3 center = 0.5 * (inner.low + inner.high), half = 0.5 * (inner.high - inner.low);
  std::array<glm::dvec3, 3> corners = triangle.corners;
  for (glm::dvec3& corner : corners) corner -= center;
  constexpr glm::dmat3 kAxes(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    if (separates(kAxes[axis], corners, half)) return false;
  }
  const std::array edges = {corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]};
  if (separates(glm::cross(edges[0], edges[1]), corners, half)) return false;
  for (const glm::dvec3& edge : edges) {
    for (int axis = 0; axis < 3; ++axis) {
      const glm::dvec3 across = glm::cross(edge, kAxes[axis]);
      if (across != glm::dvec3(0) && separates(across, corners, half)) return false;
    }
  }
  return true;
}

bool overlaps(const CellSolid& solid, const CellBox& box) {
  const CellBox inner = grown(box, -solid.rounding);
  if (is_empty(inner) || !reaches_inside(solid, inner)) return false;
  const Corners corners = corners_in_shape_frame(solid, grown(box, solid.rounding));
  return std::ranges::any_of(corners, [&](const glm::dvec3& corner) { return !is_inside(solid, corner); });
}

CellDisc settle(CellDisc disc) {
  // The plane is normal . (mesh_from_cells * cells + offset) = 0.
  const glm::dvec3 along = glm::transpose(disc.mesh_from_cells) * disc.normal;
  for (int axis = 0; axis < 3; ++axis) {
    const double across = std::abs(along[(axis + 1) % 3]) + std::abs(along[(axis + 2) % 3]);
    if (across > disc.rounding * std::abs(along[axis])) continue;
    const double plane = -glm::dot(disc.normal, disc.offset) / along[axis], boundary = std::round(plane);
    if (std::abs(plane - boundary) > disc.rounding) continue;
    const double move = boundary - plane + (along[axis] > 0 ? -0.5 : 0.5);
    disc.offset -= disc.mesh_from_cells[axis] * move;
    break;
  }
  return disc;
}

bool overlaps(const CellDisc& disc, const CellBox& box) {
  const CellBox inner = grown(box, -disc.rounding);
  if (is_empty(inner)) return false;
  Corners corners;
  std::array<double, 8> heights{};
  for (unsigned i = 0; i < 8; ++i) {
    corners[i] = disc.mesh_from_cells * corner_of(inner, i) + disc.offset;
    heights[i] = glm::dot(disc.normal, corners[i]);
  }
  if (*std::ranges::max_element(heights) <= 0 || *std::ranges::min_element(heights) >= 0) return false;
  const glm::dvec3 aside = std::abs(disc.normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(aside, disc.normal)), v = glm::cross(disc.normal, u);
  Polygon polygon;
  for_each_edge([&](unsigned i, unsigned k) {
    if ((heights[i] < 0) == (heights[k] < 0)) return;
    const glm::dvec3 point = glm::mix(corners[i], corners[k], heights[i] / (heights[i] - heights[k]));
    polygon.points.emplace_back(glm::dot(u, point), glm::dot(v, point));
  });
  return comes_within(polygon, disc.radius);
}

}  // namespace simvis
