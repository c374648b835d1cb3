// Traversal of a grid of heights by one ray, in double: it finds the cells that the ray may meet.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/raycast/height_grid.h"

namespace simvis {

/// A ray in the frame of the mesh: its points are from + t way, with t the range in metres.
struct GridRay {
  glm::dvec3 from{0}, way{0};
  glm::dvec3 pad{0};  ///< a triangle that the ray meets by the exact test at t lies no farther from its point at t
};

/// A part of a ray: t from `first` to `last`; empty if that is less.
struct GridSpan {
  double first = 0, last = 0;

  bool any() const { return first <= last; }
};

/// A ray on its way through a grid, see traverse_grid().
template <class TryCell>
class GridTraversal {
 public:
  GridTraversal(const Mesh& mesh, const HeightPyramid& pyramid, const GridRay& ray, GridSpan span,
                const TryCell& try_cell)
      : mesh_(mesh), pyramid_(pyramid), ray_(ray), span_(span), try_cell_(try_cell) {
    // A component that is smaller than this moves no point by as much as the pad.
    constexpr double kSmallest = 1e-200;
    for (int axis = 0; axis < 3; ++axis) {
      const double way = ray.way[axis];
      per_way_[axis] = 1 / (std::abs(way) < kSmallest ? kSmallest : way);
    }
    const std::vector<double>&x_m = pyramid.x_m(), &y_m = pyramid.y_m();
    flip_ = {(per_way_.x < 0) != (x_m.back() < x_m.front()) ? 1u : 0u,
             (per_way_.y < 0) != (y_m.back() < y_m.front()) ? 1u : 0u};
    room_ = glm::dvec2(ray.pad) * glm::abs(glm::dvec2(per_way_));
  }

  void go() {
    // Of each level, up to three blocks wait while the fourth is visited.
    constexpr std::size_t kMaxLevels = 32;
    std::array<Waiting, 3 * kMaxLevels + 1> stack;
    std::size_t waiting = 0;
    const auto await = [&](const Waiting& block) {
      const HeightPyramid::Heights& heights = pyramid_.heights(block.level, block.block);
      if (!meets(block.span, static_cast<double>(heights.low), static_cast<double>(heights.high))) return;
      stack[waiting++] = block;
      if (block.level == 0) fetch(block.block);
    };
    const std::array<double, 2> x = planes<2>(0, pyramid_.levels(), 0), y = planes<2>(1, pyramid_.levels(), 0);
    await({pyramid_.levels() - 1, glm::uvec2(0), part(x, 0, y, 0, span_)});
    while (waiting > 0) {
      Waiting next = stack[--waiting];
      next.span.last = std::min(next.span.last, span_.last);
      if (!next.span.any()) continue;
      if (next.level == 0) {
        visit_cells(next);
      } else {
        split(next, await);
      }
    }
  }

 private:
  struct Waiting {
    std::uint32_t level = 0;
    glm::uvec2 block{0};
    GridSpan span;
  };

  const std::vector<double>& places_m(int axis) const { return axis == 0 ? pyramid_.x_m() : pyramid_.y_m(); }

  // The values of t at which the ray crosses the N planes that bound N - 1 neighbouring blocks along an axis,
  // ascending. `level_plus_1` is the number of the level of the blocks plus 1; 0 stands for single cells. `first` is
  // the number of the first block.
  template <std::size_t N>
  std::array<double, N> planes(int axis, std::uint32_t level_plus_1, std::uint32_t first) const {
    const std::vector<double>& at_m = places_m(axis);
    const std::uint32_t shift = level_plus_1 == 0 ? 0 : HeightPyramid::kBlockShift + level_plus_1 - 1;
    std::array<double, N> t;
    for (std::size_t k = 0; k < N; ++k) {
      const std::uint64_t number = std::min((std::uint64_t{first} + k) << shift, std::uint64_t{at_m.size() - 1});
      t[flip_[axis] != 0 ? N - 1 - k : k] = (at_m[number] - ray_.from[axis]) * per_way_[axis];
    }
    return t;
  }

  // The part of a span between two planes of each axis, or within the pad of them.
  template <std::size_t N>
  GridSpan part(const std::array<double, N>& x, std::size_t i, const std::array<double, N>& y, std::size_t j,
                const GridSpan& span) const {
    return {std::max({span.first, x[i] - room_.x, y[j] - room_.y}),
            std::min({span.last, x[i + 1] + room_.x, y[j + 1] + room_.y})};
  }

  // Whether the ray comes between two heights, or within the pad of them, in a span.
  bool meets(const GridSpan& span, double low, double high) const {
    if (!span.any()) return false;
    const double a = ray_.from.z + span.first * ray_.way.z, b = ray_.from.z + span.last * ray_.way.z;
    return !(std::min(a, b) > high + ray_.pad.z || std::max(a, b) < low - ray_.pad.z);
  }

  // Farther blocks wait below nearer ones.
  template <class Await>
  void split(const Waiting& block, const Await& await) {
    const std::uint32_t level = block.level - 1;
    const glm::uvec2 blocks = pyramid_.blocks(level), first = 2u * block.block;
    const std::array<double, 3> x = planes<3>(0, level + 1, first.x), y = planes<3>(1, level + 1, first.y);
    for (std::uint32_t k = 4; k-- > 0;) {
      const std::uint32_t i = k & 1, j = k >> 1;
      const glm::uvec2 child = first + glm::uvec2(i ^ flip_.x, j ^ flip_.y);
      if (child.x < blocks.x && child.y < blocks.y) await({level, child, part(x, i, y, j, block.span)});
    }
  }

  // Prefetches the vertices of a smallest block.
  void fetch(const glm::uvec2& block) const {
    const std::uint32_t column = block.x << HeightPyramid::kBlockShift, row = block.y << HeightPyramid::kBlockShift;
    const std::uint32_t end = std::min(row + kSide + 1, pyramid_.size().rows);
    for (std::uint32_t j = row; j < end; ++j) {
      __builtin_prefetch(&mesh_.positions[std::size_t{j} * pyramid_.size().columns + column]);
    }
  }

  void visit_cells(const Waiting& block) {
    const glm::uvec2 first = block.block << HeightPyramid::kBlockShift;
    const glm::uvec2 cells(pyramid_.size().columns - 1, pyramid_.size().rows - 1);
    const std::array<double, kSide + 1> x = planes<kSide + 1>(0, 0, first.x), y = planes<kSide + 1>(1, 0, first.y);
    for (std::uint32_t j = 0; j < kSide; ++j) {
      const std::uint32_t row = first.y + (flip_.y != 0 ? kSide - 1 - j : j);
      if (row >= cells.y || y[j] - room_.y > span_.last || y[j + 1] + room_.y < block.span.first) continue;
      for (std::uint32_t i = 0; i < kSide; ++i) {
        const std::uint32_t column = first.x + (flip_.x != 0 ? kSide - 1 - i : i);
        if (column >= cells.x) continue;
        const GridSpan span = part(x, i, y, j, {block.span.first, std::min(block.span.last, span_.last)});
        if (span.any()) visit_cell(column, row, span);
      }
    }
  }

  void visit_cell(std::uint32_t column, std::uint32_t row, const GridSpan& span) {
    const std::size_t columns = pyramid_.size().columns;
    const glm::vec3* const above = &mesh_.positions[row * columns + column];
    const glm::vec3* const below = above + columns;
    const auto [low, high] = std::minmax({above[0].z, above[1].z, below[0].z, below[1].z});
    if (!meets(span, static_cast<double>(low), static_cast<double>(high))) return;
    span_.last = try_cell_(static_cast<std::uint32_t>(row * (columns - 1) + column));
  }

  static constexpr std::uint32_t kSide = 1u << HeightPyramid::kBlockShift;  // cells along a smallest block

  const Mesh& mesh_;
  const HeightPyramid& pyramid_;
  const GridRay& ray_;
  GridSpan span_;
  const TryCell& try_cell_;
  glm::dvec3 per_way_{0};
  glm::dvec2 room_{0};  // the pad as a part of the ray across the planes of x and y
  glm::uvec2 flip_{0};  // 1: the ray passes the cells along this axis in descending order
};

/// Calls `try_cell` with the numbers of the cells that the ray may meet between t = `start` and `end`, nearer blocks
/// first. It returns the end from then on, which is not greater than the one before. `mesh` is that of the pyramid.
template <class TryCell>
void traverse_grid(const Mesh& mesh, const HeightPyramid& pyramid, const GridRay& ray, double start, double end,
                   const TryCell& try_cell) {
  GridTraversal<TryCell>(mesh, pyramid, ray, {start, end}, try_cell).go();
}

}  // namespace simvis
