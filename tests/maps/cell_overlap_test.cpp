// Whether surfaces pass through boxes: cases by hand, and two other ways to decide it.
#include "program/maps/cell_overlap.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <vector>

TEST_SUITE_BEGIN("maps");

namespace simvis {
namespace {

constexpr CellBox kCell{glm::dvec3(0), glm::dvec3(1)};

// Decisions are compared where they hold for boxes that are larger and smaller by this, in cells: the references round
// by less than 1e-12 of the lengths here, which are below 10.
constexpr double kClear = 1e-9;

CellBox grown(const CellBox& box, double by) { return {box.low - by, box.high + by}; }

bool passes(const CellTriangle& triangle, const CellBox& box) {
  const std::optional<CellTriangle> settled = settle(triangle);
  return settled && overlaps(*settled, box);
}

TEST_CASE("a triangle passes through the cells that it enters, not through those that it touches") {
  const glm::dvec3 a(0.2, 0.2, 0.5), b(0.8, 0.2, 0.5), c(0.5, 0.8, 0.5);
  CHECK(passes({{a, b, c}}, kCell));
  const auto moved = [&](const glm::dvec3& by) { return CellTriangle{{a + by, b + by, c + by}}; };
  CHECK_FALSE(passes(moved({0, 0, 1}), kCell));
  CHECK_FALSE(passes(moved({0.8, 0, 0}), kCell));  // touches x = 1 with a corner
  CHECK(passes(moved({0.8 - kClear, 0, 0}), kCell));
  CHECK_FALSE(passes({{{{1, -1, -1}, {1, 2, 3}, {3, 0, 0}}}}, kCell));                  // touches x = 1 with an edge
  CHECK_FALSE(passes({{{{1, 1, 1}, {2, 1.5, 1}, {1.5, 2, 1.2}}}}, kCell));              // touches a corner of the cell
  CHECK_FALSE(passes({{{{2, 0, 0.5}, {0, 2, 0.5}, {2, 2, 0.5}}}}, kCell));              // touches an edge of the cell
  CHECK(passes({{{{-9, -9, 0.5}, {9, -9, 0.5}, {0, 9, 0.5}}}}, kCell));                 // is much larger than the cell
  CHECK_FALSE(passes({{{{0.5, 0.5, 0.5}, {0.6, 0.6, 0.6}, {0.7, 0.7, 0.7}}}}, kCell));  // has no area
}

TEST_CASE("a triangle in the boundary of two cells belongs to the one behind it") {
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool is_forward : {true, false}) {
      CAPTURE(axis);
      CAPTURE(is_forward);
      // Counter-clockwise seen from the positive end of the axis, in the boundary at 0.
      CellTriangle triangle;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      triangle.corners[1][u] = triangle.corners[2][v] = 1;
      if (!is_forward) std::swap(triangle.corners[1], triangle.corners[2]);
      glm::dvec3 behind(0), beside(0);
      behind[axis] = is_forward ? -1 : 0;
      beside = behind;
      beside[u] = 1;
      glm::dvec3 before(0);
      before[axis] = is_forward ? 0 : -1;
      CHECK(passes(triangle, {behind, behind + 1.0}));
      CHECK_FALSE(passes(triangle, {before, before + 1.0}));
      CHECK_FALSE(passes(triangle, {beside, beside + 1.0}));
      for (const double rounding : {0.0, 1e-7}) {  // a corner that rounding has moved across the boundary
        CellTriangle rounded = triangle;
        rounded.corners[2][axis] += is_forward ? 1e-8 : -1e-8;
        rounded.rounding = glm::dvec3(rounding);
        CHECK(passes(rounded, {before, before + 1.0}) == (rounding == 0));
      }
    }
  }
}

// The area of the part of a triangle in a box, by cutting it at each side (Sutherland and Hodgman 1974).
double area_within(const CellTriangle& triangle, const CellBox& box) {
  std::vector<glm::dvec3> polygon(triangle.corners.begin(), triangle.corners.end());
  for (int axis = 0; axis < 3; ++axis) {
    for (const double way : {1.0, -1.0}) {
      const double limit = way > 0 ? box.low[axis] : -box.high[axis];
      std::vector<glm::dvec3> kept;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec3 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
        const double a = way * from[axis] - limit, b = way * to[axis] - limit;
        if (a >= 0) kept.push_back(from);
        if ((a < 0) != (b < 0)) kept.push_back(from + a / (a - b) * (to - from));
      }
      polygon = kept;
    }
  }
  glm::dvec3 sum(0);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
    sum += glm::cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
  }
  return glm::length(sum) / 2;
}

glm::dvec3 random_point(std::mt19937_64& random, double within) {
  std::uniform_real_distribution<double> number(-within, within);
  const double x = number(random), y = number(random);
  return {x, y, number(random)};
}

TEST_CASE("random triangles pass through the boxes in which a part of them has an area") {
  std::mt19937_64 random(7);
  int inside = 0, outside = 0;
  for (int i = 0; i < 200'000; ++i) {
    const double size = i % 3 == 0 ? 0.4 : 2;
    const glm::dvec3 middle = random_point(random, 2);
    const CellTriangle triangle{{middle + random_point(random, size), middle + random_point(random, size),
                                 middle + random_point(random, size)}};
    const CellBox box{glm::dvec3(0), glm::dvec3(i % 5 + 1, i % 2 + 1, 1)};
    const bool is_within = area_within(triangle, grown(box, -kClear)) > 0;
    const bool is_near = area_within(triangle, grown(box, kClear)) > 0;
    if (is_within != is_near) continue;
    (is_within ? inside : outside)++;
    if (overlaps(triangle, box) != is_within) FAIL_CHECK("triangle " << i);
  }
  CHECK(inside > 20'000);
  CHECK(outside > 20'000);
}

TEST_CASE("random rectangles in the planes of cells occupy the cells behind them, all within and no others") {
  std::mt19937_64 random(3);
  std::uniform_int_distribution<int> whole(-3, 3);
  for (int i = 0; i < 300; ++i) {
    const int axis = i % 3, u = (axis + 1) % 3, v = (axis + 2) % 3, plane = whole(random);
    const glm::ivec2 low(whole(random), whole(random)), size(std::abs(whole(random)) + 1, std::abs(whole(random)) + 1);
    const auto corner = [&](int x, int y) {
      glm::dvec3 point;
      point[axis] = plane;
      point[u] = low.x + x * size.x;
      point[v] = low.y + y * size.y;
      return point;
    };
    const CellTriangle one{{corner(0, 0), corner(1, 0), corner(1, 1)}},
        other{{corner(0, 0), corner(1, 1), corner(0, 1)}};
    int occupied = 0;
    for (int x = -8; x < 8; ++x) {
      for (int y = -8; y < 8; ++y) {
        for (const int layer : {plane - 1, plane}) {
          glm::dvec3 cell;
          cell[axis] = layer;
          cell[u] = x;
          cell[v] = y;
          const CellBox box{cell, cell + 1.0};
          const bool is_in = passes(one, box) || passes(other, box);
          const bool expected =
              layer == plane - 1 && x >= low.x && x < low.x + size.x && y >= low.y && y < low.y + size.y;
          CHECK(is_in == expected);
          occupied += is_in ? 1 : 0;
        }
      }
    }
    CHECK(occupied == size.x * size.y);
  }
}

using Gauge = std::function<double(const glm::dvec3&)>;

// A convex function of points in the frame of the shape, which is below 0 inside of it.
Gauge gauge_of(const CellSolid& solid) {
  const double r = solid.radius, h = solid.half_length;
  switch (solid.kind) {
    case SurfaceKind::sphere:
      return [=](const glm::dvec3& p) { return glm::length(p) - r; };
    case SurfaceKind::capsule:
      return
          [=](const glm::dvec3& p) { return glm::length(glm::dvec3(p.x, p.y, std::max(std::abs(p.z) - h, 0.0))) - r; };
    case SurfaceKind::cylinder:
      return [=](const glm::dvec3& p) { return std::max(std::hypot(p.x, p.y) - r, std::abs(p.z) - h); };
    default:
      return [=](const glm::dvec3& p) { return std::max(std::hypot(p.x, p.y) - r * (h - p.z) / (2 * h), -h - p.z); };
  }
}

// The smallest value of a convex function over an interval, by golden sections.
double smallest(const std::function<double(double)>& f, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low), fa = f(a), fb = f(b);
  double least = std::min({f(low), f(high), fa, fb});
  for (int i = 0; i < 34; ++i) {
    if (fa < fb) {
      high = b;
      b = a;
      fb = fa;
      fa = f(a = high - kGolden * (high - low));
    } else {
      low = a;
      a = b;
      fa = fb;
      fb = f(b = low + kGolden * (high - low));
    }
    least = std::min({least, fa, fb});
  }
  return least;
}

double smallest_in(const CellSolid& solid, const CellBox& box) {
  const Gauge gauge = gauge_of(solid);
  return smallest(
      [&](double x) {
        return smallest(
            [&](double y) {
              return smallest(
                  [&](double z) { return gauge(solid.shape_from_cells * glm::dvec3(x, y, z) + solid.offset); },
                  box.low.z, box.high.z);
            },
            box.low.y, box.high.y);
      },
      box.low.x, box.high.x);
}

double largest_in(const CellSolid& solid, const CellBox& box) {
  double largest = -INFINITY;
  for (unsigned i = 0; i < 8; ++i) {
    const glm::dvec3 corner = glm::mix(box.low, box.high, glm::dvec3(i & 1, i >> 1 & 1, i >> 2 & 1));
    largest = std::max(largest, gauge_of(solid)(solid.shape_from_cells * corner + solid.offset));
  }
  return largest;
}

glm::dmat3 random_transform(std::mt19937_64& random, int kind) {
  if (kind == 0) return glm::dmat3(1.0);
  const glm::dvec3 axis = glm::normalize(random_point(random, 1) + glm::dvec3(1e-3));
  glm::dmat3 matrix(glm::rotate(glm::dmat4(1), random_point(random, 3).x, axis));
  if (kind == 2) matrix = matrix * glm::dmat3(1.5, 0, 0, 0, 0.6, 0, 0, 0, -1.2);  // mirrored and stretched
  return matrix;
}

TEST_CASE("the surfaces of round shapes pass through the boxes that are partly inside, under any transform") {
  // Golden sections come as near to the minimum as the interval shrinks, below 1e-6; the shapes have gradients below 2.
  constexpr double kSection = 5e-6;
  std::mt19937_64 random(11);
  for (const SurfaceKind kind : {SurfaceKind::sphere, SurfaceKind::cylinder, SurfaceKind::cone, SurfaceKind::capsule}) {
    CAPTURE(static_cast<int>(kind));
    int passing = 0, within = 0, outside = 0;
    for (int i = 0; i < 120; ++i) {
      CellSolid solid{.kind = kind, .radius = 0.9, .half_length = kind == SurfaceKind::sphere ? 0 : 0.8};
      solid.shape_from_cells = random_transform(random, i % 3);
      const bool is_small = i % 4 == 0;
      solid.offset = random_point(random, is_small ? 0.8 : 1.6);
      const double side = is_small ? 0.2 : 1;
      const CellBox box{glm::dvec3(-side / 2), glm::dvec3(side / 2)};
      const double low = smallest_in(solid, box), high = largest_in(solid, box);
      if (std::abs(low) < kSection || std::abs(high) < kSection) continue;
      const bool expected = low < 0 && high > 0;
      (expected ? passing : low < 0 ? within : outside)++;
      CHECK_MESSAGE(overlaps(solid, box) == expected, i);
    }
    CHECK(passing > 15);
    CHECK(outside > 5);
    CHECK(within > 2);
  }
}

TEST_CASE("a round shape that touches a cell from outside does not occupy it, from inside it does") {
  CellSolid cylinder{.kind = SurfaceKind::cylinder, .radius = 1, .half_length = 1, .rounding = 1e-12};
  const CellBox above{{-0.2, -0.2, 1}, {0.2, 0.2, 2}}, below_top{{-0.2, -0.2, 0.5}, {0.2, 0.2, 1}},
      beside{{1, -0.5, -0.5}, {2, 0.5, 0.5}}, middle{{-0.2, -0.2, -0.5}, {0.2, 0.2, 0.5}};
  CHECK_FALSE(overlaps(cylinder, above));
  CHECK(overlaps(cylinder, below_top));
  CHECK_FALSE(overlaps(cylinder, beside));
  CHECK_FALSE(overlaps(cylinder, middle));
  cylinder.kind = SurfaceKind::cone;  // its tip touches the cell above
  CHECK_FALSE(overlaps(cylinder, above));
  CHECK(overlaps(cylinder, below_top));
}

TEST_CASE("discs occupy the cells that they enter, and those behind them where they lie in a boundary") {
  const CellDisc across{.radius = 0.5, .offset = {-0.5, -0.5, -0.5}, .normal = glm::normalize(glm::dvec3(1, 1, 1))};
  CHECK(overlaps(across, kCell));
  CHECK_FALSE(overlaps(across, {{2, 2, 2}, {3, 3, 3}}));
  // Its rim comes to 0.5 + 0.5 sqrt(2 / 3) = 0.908 along each axis.
  CHECK(overlaps(across, {{0.907, 0, 0}, {2, 1, 1}}));
  CHECK_FALSE(overlaps(across, {{0.909, 0, 0}, {2, 1, 1}}));
  for (const double way : {1.0, -1.0}) {
    const CellDisc flat = settle({.radius = 0.4, .offset = {-0.5, -0.5, 0}, .normal = {0, 0, way}, .rounding = 1e-12});
    CHECK(overlaps(flat, {{0, 0, -1}, {1, 1, 0}}) == (way > 0));
    CHECK(overlaps(flat, kCell) == (way < 0));
    CHECK_FALSE(overlaps(flat, {{1, 0, -1}, {2, 1, 1}}));
  }
}

}  // namespace
}  // namespace simvis
