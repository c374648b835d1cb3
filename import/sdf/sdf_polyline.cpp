#include "import/sdf/sdf_polyline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/pose.h>

namespace simvis {
namespace {

using Points = std::vector<glm::dvec2>;
constexpr std::size_t kMaxPolylinePoints = 2000;  // the time grows with the square of their number

double cross_of(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double area_of(const Points& points) {
  double sum = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec2 &a = points[i], &b = points[(i + 1) % points.size()];
    sum += a.x * b.y - a.y * b.x;
  }
  return sum / 2;
}

bool cross_each_other(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
  return cross_of(a, b, c) * cross_of(a, b, d) < 0 && cross_of(c, d, a) * cross_of(c, d, b) < 0;
}

void check_sides(const SdfElement& polyline, const Points& points) {
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if (!cross_each_other(points[i], points[i + 1], points[j], points[(j + 1) % n])) continue;
      polyline.fail("has sides that cross each other");
    }
  }
}

// Counter-clockwise.
Points polygon_of(const SdfElement& polyline) {
  Points points;
  for (const SdfElement& child : polyline.children()) {
    if (child.tag() != "point") continue;
    points.push_back(child.vector(glm::dvec2(0)));
    const bool is_near = std::max(std::abs(points.back().x), std::abs(points.back().y)) <= kMaxCoordinate_m;
    if (!is_near) child.fail("has a coordinate beyond " + format_number(kMaxCoordinate_m) + " m");
  }
  if (points.size() > 1 && points.front() == points.back()) points.pop_back();
  if (points.size() < 3 || points.size() > kMaxPolylinePoints) {
    polyline.fail("has " + std::to_string(points.size()) + " points, expected from 3 to " +
                  std::to_string(kMaxPolylinePoints));
  }
  check_sides(polyline, points);
  if (area_of(points) < 0) std::ranges::reverse(points);
  return points;
}

bool holds(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& p) {
  return p != a && p != b && p != c && cross_of(a, b, p) >= 0 && cross_of(b, c, p) >= 0 && cross_of(c, a, p) >= 0;
}

// Cuts off the first corner that sticks out and holds no other point. Empty: there is none, since sides cross.
std::optional<std::array<std::size_t, 3>> cut_ear(const Points& points, std::vector<std::size_t>& left) {
  for (std::size_t i = 0; i < left.size(); ++i) {
    const std::size_t before = left[(i + left.size() - 1) % left.size()], at = left[i],
                      after = left[(i + 1) % left.size()];
    const glm::dvec2 &a = points[before], &b = points[at], &c = points[after];
    if (!(cross_of(a, b, c) > 0)) continue;
    if (std::ranges::any_of(left, [&](std::size_t other) { return holds(a, b, c, points[other]); })) continue;
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
    return std::array{before, at, after};
  }
  return std::nullopt;
}

std::vector<std::array<std::size_t, 3>> triangulate(const SdfElement& polyline, const Points& points) {
  std::vector<std::size_t> left(points.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  std::vector<std::array<std::size_t, 3>> triangles;
  while (left.size() > 3) {
    const auto ear = cut_ear(points, left);
    if (!ear) polyline.fail("has sides that touch each other, or points in one line");
    triangles.push_back(*ear);
  }
  triangles.push_back({left[0], left[1], left[2]});
  return triangles;
}

std::uint32_t add_point(Mesh& mesh, const glm::dvec2& at, double z, const glm::dvec3& normal) {
  VertexAttributes attributes;
  attributes.normal = glm::vec3(normal);
  mesh.positions.emplace_back(at.x, at.y, z);
  mesh.attributes.push_back(attributes);
  return static_cast<std::uint32_t>(mesh.positions.size() - 1);
}

}  // namespace

Mesh sdf_polyline_mesh(const SdfElement& polyline) {
  const Points points = polygon_of(polyline);
  const double height_m = polyline.child("height").number(1);
  if (!(height_m > 0 && height_m <= kMaxCoordinate_m)) polyline.fail("has a <height> that is not above 0");
  Mesh mesh;
  mesh.name = "polyline";
  const auto triangles = triangulate(polyline, points);
  for (const double z : {0.0, height_m}) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::dvec2& point : points) add_point(mesh, point, z, {0, 0, z > 0 ? 1 : -1});
    for (auto [a, b, c] : triangles) {
      if (z == 0) std::swap(b, c);
      for (const std::size_t corner : {a, b, c}) mesh.indices.push_back(first + static_cast<std::uint32_t>(corner));
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec2 &a = points[i], &b = points[(i + 1) % points.size()];
    if (a == b) polyline.fail("has two equal points beside each other");
    const glm::dvec2 way = glm::normalize(b - a);
    const glm::dvec3 normal(way.y, -way.x, 0);
    const std::uint32_t first = add_point(mesh, a, 0, normal);
    add_point(mesh, b, 0, normal);
    add_point(mesh, b, height_m, normal);
    add_point(mesh, a, height_m, normal);
    mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
  }
  compute_bounds(mesh);
  return mesh;
}

}  // namespace simvis
