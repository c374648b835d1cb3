#include "engine/geometry/surface_deviation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/base/assert.h"
#include "engine/base/thread_pool.h"
#include "engine/geometry/bvh.h"

namespace simvis {
namespace {

using TrianglePoints = std::array<glm::dvec3, 3>;

// A piece is divided until its bound exceeds the distance of its centre by less than this factor.
constexpr double kTight = 1.2;

// Each division halves the sides of a piece.
constexpr int kMaxDivisions = 7;

constexpr std::uint32_t kTrianglesOfLeaf = 4;
constexpr std::size_t kTrianglesOfPiece = 256;

TrianglePoints points_of(const TriangleSurface& surface, std::size_t triangle) {
  const auto corner = [&](std::size_t i) { return glm::dvec3(surface.positions[surface.indices[3 * triangle + i]]); };
  return {corner(0), corner(1), corner(2)};
}

glm::dvec3 closest_on_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double square = glm::dot(along, along);
  return square == 0 ? a : a + std::clamp(glm::dot(p - a, along) / square, 0.0, 1.0) * along;
}

double square_distance(const glm::dvec3& p, const glm::dvec3& q) { return glm::dot(p - q, p - q); }

// The square of the distance of a point from a triangle, which may be degenerate.
double square_distance(const glm::dvec3& p, const TrianglePoints& t) {
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double square = glm::dot(normal, normal);
  bool within = square > 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 &a = t[static_cast<std::size_t>(i)], &b = t[static_cast<std::size_t>((i + 1) % 3)];
    within = within && glm::dot(glm::cross(b - a, p - a), normal) >= 0;
    nearest = std::min(nearest, square_distance(p, closest_on_segment(p, a, b)));
  }
  const double height = glm::dot(p - t[0], normal);
  return within ? std::min(nearest, height * height / square) : nearest;
}

double square_distance(const glm::dvec3& p, const BvhNode& node) {
  return square_distance(p, glm::clamp(p, glm::dvec3(node.low), glm::dvec3(node.high)));
}

/// The distances of points from a surface.
class SurfaceTree {
 public:
  SurfaceTree(const TriangleSurface& surface, ThreadPool* pool) {
    std::vector<Box> boxes(surface.indices.size() / 3);
    for (std::size_t t = 0; t < boxes.size(); ++t) {
      const TrianglePoints& c = corners_.emplace_back(points_of(surface, t));
      boxes[t] = {glm::vec3(glm::min(c[0], glm::min(c[1], c[2]))), glm::vec3(glm::max(c[0], glm::max(c[1], c[2])))};
    }
    bvh_ = build_bvh(boxes, kTrianglesOfLeaf, 1, pool);
  }

  struct Nearest {
    const TrianglePoints* triangle = nullptr;
    double square = std::numeric_limits<double>::infinity();
  };

  /// The triangle nearest to a point. The search begins with `hint`, a triangle that may be near.
  Nearest nearest(const glm::dvec3& p, const TrianglePoints* hint) const {
    Nearest found{hint, square_distance(p, *hint)};
    std::array<std::uint32_t, Bvh::kMaxDepth + 1> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const BvhNode& node = bvh_.nodes[stack[--size]];
      if (square_distance(p, node) >= found.square) continue;
      if (node.count == 0) {
        const bool second = square_distance(p, bvh_.nodes[node.first + 1]) < square_distance(p, bvh_.nodes[node.first]);
        stack[size++] = node.first + (second ? 0 : 1);
        stack[size++] = node.first + (second ? 1 : 0);
        continue;
      }
      for (const std::uint32_t t : std::span(bvh_.order).subspan(node.first, node.count)) {
        const double square = square_distance(p, corners_[t]);
        if (square < found.square) found = {&corners_[t], square};
      }
    }
    return found;
  }

  const TrianglePoints* any() const { return &corners_[bvh_.order[0]]; }

 private:
  std::vector<TrianglePoints> corners_;
  Bvh bvh_;
};

// A bound on the distance of every point of a piece of a triangle. The distance from one triangle is a convex function,
// so over the piece it is largest at a corner; and no point of the piece is farther from its centre than a corner is.
double piece_deviation(const TrianglePoints& piece, const SurfaceTree& other, double floor, const TrianglePoints*& hint,
                       int divisions) {
  const glm::dvec3 center = (piece[0] + piece[1] + piece[2]) / 3.0;
  const SurfaceTree::Nearest nearest = other.nearest(center, hint);
  hint = nearest.triangle;
  double farthest = 0, radius = 0;
  for (const glm::dvec3& corner : piece) {
    farthest = std::max(farthest, square_distance(corner, *nearest.triangle));
    radius = std::max(radius, square_distance(corner, center));
  }
  const double distance = std::sqrt(nearest.square);
  const double bound = std::min(std::sqrt(farthest), distance + std::sqrt(radius));
  if (bound <= std::max(floor, kTight * distance) || divisions == kMaxDivisions) return bound;
  const glm::dvec3 ab = (piece[0] + piece[1]) * 0.5, bc = (piece[1] + piece[2]) * 0.5, ca = (piece[2] + piece[0]) * 0.5;
  double largest = 0;
  for (const TrianglePoints& part :
       {TrianglePoints{piece[0], ab, ca}, {ab, piece[1], bc}, {ca, bc, piece[2]}, {bc, ca, ab}}) {
    largest = std::max(largest, piece_deviation(part, other, floor, hint, divisions + 1));
  }
  return largest;
}

double one_sided(const TriangleSurface& surface, const SurfaceTree& other, double floor, ThreadPool* pool) {
  const std::size_t triangles = surface.indices.size() / 3;
  std::vector<double> largest((triangles + kTrianglesOfPiece - 1) / kTrianglesOfPiece, 0);
  const auto measure = [&](std::size_t first, std::size_t count) {
    const TrianglePoints* hint = nullptr;
    for (std::size_t t = first; t < first + count; ++t) {
      if (t % kTrianglesOfPiece == 0) hint = other.any();  // so that threads do not decide between equally near ones
      double& worst = largest[t / kTrianglesOfPiece];
      worst = std::max(worst, piece_deviation(points_of(surface, t), other, floor, hint, 0));
    }
  };
  if (pool == nullptr) {
    measure(0, triangles);
  } else {
    pool->parallel_for(triangles, kTrianglesOfPiece,
                       [&](std::size_t, std::size_t first, std::size_t count) { measure(first, count); });
  }
  return *std::ranges::max_element(largest);
}

}  // namespace

double surface_deviation(const TriangleSurface& a, const TriangleSurface& b, double floor, ThreadPool* pool) {
  SIMVIS_ASSERT(!a.indices.empty() && !b.indices.empty() && floor > 0);
  return std::max(one_sided(a, SurfaceTree(b, pool), floor, pool), one_sided(b, SurfaceTree(a, pool), floor, pool));
}

}  // namespace simvis
