#include "engine/geometry/surface_deviation.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>

#include "engine/base/assert.h"
#include "engine/base/thread_pool.h"

namespace simvis {
namespace {

using Triangle = SurfaceTree::Triangle;

// The bound may exceed the distance by this factor.
constexpr double kTight = 1.2;

// Each halves the sides of a piece.
constexpr int kMaxDivisions = 7;

// Cuts and divisions of a triangle, one after the other. A plane of n triangles needs about 2 log2(n) cuts.
constexpr int kMaxDepth = 64;

constexpr std::uint32_t kTrianglesOfLeaf = 4;
constexpr std::size_t kTrianglesOfTask = 256;

double square_distance(const glm::dvec3& p, const glm::dvec3& q) { return glm::dot(p - q, p - q); }

glm::dvec3 closest_on_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double square = glm::dot(along, along);
  return square == 0 ? a : a + std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) * along;
}

glm::dvec3 closest_on_sides(const glm::dvec3& p, const Triangle& t) {
  glm::dvec3 closest = t[0];
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 q = closest_on_segment(p, t[i], t[(i + 1) % 3]);
    if (square_distance(p, q) < square_distance(p, closest)) closest = q;
  }
  return closest;
}

// The point of a triangle, which may be degenerate, that is closest to p. It is selected by Voronoi region (corner,
// edge, face): Ericson, "Real-Time Collision Detection", 2005, section 5.1.5. Whatever rounding decides, the result
// is a point of the triangle, so its distance is a bound.
glm::dvec3 closest_point(const glm::dvec3& p, const Triangle& t) {
  const glm::dvec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0], bp = p - t[1], cp = p - t[2];
  const double a1 = glm::dot(ab, ap), a2 = glm::dot(ac, ap);
  if (a1 <= 0 && a2 <= 0) return t[0];
  const double b1 = glm::dot(ab, bp), b2 = glm::dot(ac, bp);
  if (b1 >= 0 && b2 <= b1) return t[1];
  const double weight_c = a1 * b2 - b1 * a2;
  if (weight_c < 0 && a1 >= 0 && b1 < 0) return t[0] + a1 / (a1 - b1) * ab;
  const double c1 = glm::dot(ab, cp), c2 = glm::dot(ac, cp);
  if (c2 >= 0 && c1 <= c2) return t[2];
  const double weight_b = c1 * a2 - a1 * c2;
  if (weight_b < 0 && a2 >= 0 && c2 < 0) return t[0] + a2 / (a2 - c2) * ac;
  const double weight_a = b1 * c2 - c1 * b2;
  if (weight_a < 0 && b2 >= b1 && c1 > c2) return t[1] + (b2 - b1) / (b2 - b1 + c1 - c2) * (t[2] - t[1]);
  const double sum = weight_a + weight_b + weight_c;
  if (std::min({weight_a, weight_b, weight_c}) < 0 || !(sum > 0)) return closest_on_sides(p, t);
  return t[0] + weight_b / sum * ab + weight_c / sum * ac;
}

double square_distance(const glm::dvec3& p, const Triangle& t) { return square_distance(p, closest_point(p, t)); }

double square_distance(const glm::dvec3& p, const BvhNode& node) {
  return square_distance(p, glm::clamp(p, glm::dvec3(node.low), glm::dvec3(node.high)));
}

glm::dvec3 center_of(const Triangle& t) { return (t[0] + t[1] + t[2]) / 3.0; }

// The distance from one triangle is a convex function, so over a piece it is largest at a corner.
double farthest_corner(const Triangle& piece, const Triangle& t) {
  return std::sqrt(
      std::max({square_distance(piece[0], t), square_distance(piece[1], t), square_distance(piece[2], t)}));
}

/// A side of a triangle, as a plane at right angles to the triangle.
struct SidePlane {
  glm::dvec3 normal{0};  ///< unit length, pointing outwards
  double offset = 0;

  double height(const glm::dvec3& p) const { return glm::dot(normal, p) - offset; }
};

// The side of `t` that leaves most of the piece on both sides of it, more than `margin`. None if all leave less.
std::optional<SidePlane> cutting_side(const Triangle& piece, const Triangle& t, double margin) {
  const glm::dvec3 facing = glm::cross(t[1] - t[0], t[2] - t[0]);
  std::optional<SidePlane> best;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 outwards = glm::cross(t[(i + 1) % 3] - t[i], facing);
    const double length = glm::length(outwards);
    if (!(length > 0)) return {};
    const SidePlane side{outwards / length, glm::dot(outwards, t[i]) / length};
    const double h0 = side.height(piece[0]), h1 = side.height(piece[1]), h2 = side.height(piece[2]);
    const double reach = std::min(std::max({h0, h1, h2}), -std::min({h0, h1, h2}));
    if (reach <= margin) continue;
    margin = reach;
    best = side;
  }
  return best;
}

/// Parts of a piece that together cover it.
struct Parts {
  std::array<Triangle, 4> part;
  std::size_t count = 0;
};

Parts cut(const Triangle& piece, const SidePlane& side) {
  const std::array<double, 3> height{side.height(piece[0]), side.height(piece[1]), side.height(piece[2])};
  std::size_t alone = 0;  // the corner that no other is with
  while (alone < 2 && ((height[alone] > 0) == (height[(alone + 1) % 3] > 0) ||
                       (height[alone] > 0) == (height[(alone + 2) % 3] > 0))) {
    ++alone;
  }
  const std::size_t b = (alone + 1) % 3, c = (alone + 2) % 3;
  const auto crossing = [&](std::size_t to) {
    return glm::mix(piece[alone], piece[to], height[alone] / (height[alone] - height[to]));
  };
  const glm::dvec3 on_b = crossing(b), on_c = crossing(c);
  return {{Triangle{piece[alone], on_b, on_c}, {on_b, piece[b], piece[c]}, {on_b, piece[c], on_c}}, 3};
}

Parts quarters(const Triangle& piece) {
  const glm::dvec3 ab = (piece[0] + piece[1]) * 0.5, bc = (piece[1] + piece[2]) * 0.5, ca = (piece[2] + piece[0]) * 0.5;
  return {{Triangle{piece[0], ab, ca}, {ab, piece[1], bc}, {ca, bc, piece[2]}, {bc, ca, ab}}, 4};
}

/// Bounds the distances of pieces of triangles from a surface.
class PieceBound {
 public:
  /// No piece's bound needs to be below `enough`.
  PieceBound(const SurfaceTree& other, double enough) : other_(other), enough_(enough) {}

  /// `hint` is a triangle of the surface that may be near, and becomes the one that was found last.
  ///
  /// A piece that hangs over a side of its nearest triangle is cut there: the part above the triangle is then as far
  /// from it as its corners are, and the rest has other nearest triangles. So there are about as many pieces as the two
  /// surfaces have triangles, whatever `enough` is.
  double operator()(const Triangle& piece, const Triangle*& hint, int divisions = 0, int depth = 0) const {
    if (const double near = farthest_corner(piece, *hint); near <= enough_) return near;
    const glm::dvec3 center = center_of(piece);
    const SurfaceTree::Nearest nearest = other_.nearest(center, hint, kMargin * enough_ * kMargin * enough_);
    hint = nearest.triangle;
    const double radius = std::sqrt(std::max(
        {square_distance(piece[0], center), square_distance(piece[1], center), square_distance(piece[2], center)}));
    const double distance = std::sqrt(nearest.square);
    const double bound = std::min(farthest_corner(piece, *hint), distance + radius);
    if (bound <= std::max(enough_, kTight * distance) || depth == kMaxDepth) return bound;
    const std::optional<SidePlane> side = cutting_side(piece, *hint, kMargin * enough_);
    if (!side && divisions == kMaxDivisions) return bound;
    const Parts parts = side ? cut(piece, *side) : quarters(piece);
    double largest = 0;
    for (std::size_t i = 0; i < parts.count; ++i) {
      largest = std::max(largest, (*this)(parts.part[i], hint, divisions + (side ? 0 : 1), depth + 1));
    }
    return largest;
  }

 private:
  // A piece that reaches over a side by a smaller share of what is enough is not cut there.
  static constexpr double kMargin = 0.125;

  const SurfaceTree& other_;
  double enough_;
};

// Calls `body` for parts of the triangles, on all threads.
void for_parts(std::span<const Triangle> triangles, ThreadPool* pool,
               const std::function<void(std::span<const Triangle>)>& body) {
  const std::size_t tasks = (triangles.size() + kTrianglesOfTask - 1) / kTrianglesOfTask;
  const auto run = [&](std::size_t, std::size_t first, std::size_t count) {
    for (std::size_t task = first; task < first + count; ++task) {
      const std::size_t begin = task * kTrianglesOfTask;
      body(triangles.subspan(begin, std::min(kTrianglesOfTask, triangles.size() - begin)));
    }
  };
  if (pool == nullptr) {
    run(0, 0, tasks);
  } else {
    pool->parallel_for(tasks, 1, run);
  }
}

void raise(std::atomic<double>& largest, double value) {
  double before = largest.load(std::memory_order_relaxed);
  while (before < value && !largest.compare_exchange_weak(before, value, std::memory_order_relaxed)) {
  }
}

// Raises the square of a distance to the largest one of the corners and middles of `surface` from `other`. The result
// does not depend on what other threads have found: what they spare is not above it.
void sample(const SurfaceTree& surface, const SurfaceTree& other, std::atomic<double>& square, ThreadPool* pool) {
  for_parts(surface.triangles(), pool, [&](std::span<const Triangle> part) {
    const Triangle* hint = &other.triangles().front();
    for (const Triangle& t : part) {
      for (const glm::dvec3& point : {t[0], t[1], t[2], center_of(t)}) {
        const SurfaceTree::Nearest nearest = other.nearest(point, hint, square.load(std::memory_order_relaxed));
        hint = nearest.triangle;
        raise(square, nearest.square);
      }
    }
  });
}

double one_sided(const SurfaceTree& surface, const SurfaceTree& other, double enough, ThreadPool* pool) {
  std::atomic<double> largest = 0;
  const PieceBound bound(other, enough);
  for_parts(surface.triangles(), pool, [&](std::span<const Triangle> part) {
    const Triangle* hint = &other.triangles().front();  // so that no thread's work depends on another one's
    for (const Triangle& t : part) raise(largest, bound(t, hint));
  });
  return largest;
}

}  // namespace

SurfaceTree::SurfaceTree(std::span<const glm::vec3> positions, std::span<const std::uint32_t> indices,
                         ThreadPool* pool) {
  SIMVIS_ASSERT(!indices.empty() && indices.size() % 3 == 0);
  const auto corner = [&](std::size_t triangle, std::size_t i) { return positions[indices[3 * triangle + i]]; };
  std::vector<Box> boxes(indices.size() / 3);
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    const glm::vec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    boxes[t] = {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
  }
  bvh_ = build_bvh(boxes, kTrianglesOfLeaf, 1, pool);
  triangles_.reserve(boxes.size());
  for (const std::uint32_t t : bvh_.order) triangles_.push_back({corner(t, 0), corner(t, 1), corner(t, 2)});
}

SurfaceTree::Nearest SurfaceTree::nearest(const glm::dvec3& point, const Triangle* hint, double enough) const {
  struct Entry {
    std::uint32_t node;
    double square;
  };
  std::array<Entry, Bvh::kMaxDepth + 1> stack;
  std::size_t size = 0;
  Nearest found{hint, square_distance(point, *hint)};
  stack[size++] = {0, 0};
  while (size > 0 && found.square > enough) {
    const Entry entry = stack[--size];
    if (entry.square >= found.square) continue;
    const BvhNode& node = bvh_.nodes[entry.node];
    if (node.count == 0) {
      Entry near{node.first, square_distance(point, bvh_.nodes[node.first])},
          far{node.first + 1, square_distance(point, bvh_.nodes[node.first + 1])};
      if (far.square < near.square) std::swap(near, far);
      stack[size++] = far;
      stack[size++] = near;
      continue;
    }
    for (const Triangle& t : std::span(triangles_).subspan(node.first, node.count)) {
      const double square = square_distance(point, t);
      if (square < found.square) found = {&t, square};
    }
  }
  return found;
}

double surface_deviation(const SurfaceTree& a, const SurfaceTree& b, double floor, ThreadPool* pool) {
  SIMVIS_ASSERT(floor > 0);
  std::atomic<double> square = floor / kTight * floor / kTight;
  sample(a, b, square, pool);
  sample(b, a, square, pool);
  const double enough = kTight * std::sqrt(square);
  return std::max(one_sided(a, b, enough, pool), one_sided(b, a, enough, pool));
}

}  // namespace simvis
