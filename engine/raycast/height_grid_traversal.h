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
    flip_ = {(ray.way.x < 0) != (x_m.back() < x_m.front()) ? 1u : 0u,
             (ray.way.y < 0) != (y_m.back() < y_m.front()) ? 1u : 0u};
  }

  void go() {
    // Of each level, up to three blocks wait while the fourth is visited.
    struct Waiting {
      std::uint32_t level = 0;
      glm::uvec2 block{0};
      double first = 0;
    };
    constexpr std::size_t kMaxLevels = 32;
    std::array<Waiting, 3 * kMaxLevels + 1> stack;
    std::size_t waiting = 0;
    const auto await = [&](std::uint32_t level, const glm::uvec2& block) {
      const GridSpan span = in_block(level, block);
      if (!span.any()) return;
      stack[waiting++] = {level, block, span.first};
      if (level == 0) fetch(block);
    };
    await(pyramid_.levels() - 1, glm::uvec2(0));
    while (waiting > 0) {
      const Waiting next = stack[--waiting];
      if (next.first > span_.last) continue;
      if (next.level == 0) {
        visit_cells(next.block);
        continue;
      }
      const glm::uvec2 blocks = pyramid_.blocks(next.level - 1);
      for (std::uint32_t k = 4; k-- > 0;) {
        const glm::uvec2 child = 2u * next.block + glm::uvec2((k & 1) ^ flip_.x, (k >> 1) ^ flip_.y);
        if (child.x < blocks.x && child.y < blocks.y) await(next.level - 1, child);
      }
    }
  }

 private:
  // The part of the span in which the ray is between two planes across an axis, or within the pad of them.
  GridSpan between(GridSpan span, int axis, double a, double b) const {
    const double low = std::min(a, b) - ray_.pad[axis] - ray_.from[axis],
                 high = std::max(a, b) + ray_.pad[axis] - ray_.from[axis];
    const double s = low * per_way_[axis], t = high * per_way_[axis];
    return {std::max(span.first, std::min(s, t)), std::min(span.last, std::max(s, t))};
  }

  // The first cell of a block along an axis, and the first one after it.
  glm::uvec2 cells_of(std::uint32_t level, std::uint32_t block, std::uint32_t vertices) const {
    const std::uint32_t shift = HeightPyramid::kBlockShift + level;
    return {block << shift,
            static_cast<std::uint32_t>(std::min<std::uint64_t>(std::uint64_t{block + 1} << shift, vertices - 1))};
  }

  // Prefetches the vertices of a smallest block.
  void fetch(const glm::uvec2& block) const {
    const std::uint32_t column = block.x << HeightPyramid::kBlockShift, row = block.y << HeightPyramid::kBlockShift;
    const std::uint32_t end = std::min(row + (1u << HeightPyramid::kBlockShift) + 1, pyramid_.size().rows);
    for (std::uint32_t j = row; j < end; ++j) {
      __builtin_prefetch(&mesh_.positions[std::size_t{j} * pyramid_.size().columns + column]);
    }
  }

  GridSpan in_block(std::uint32_t level, const glm::uvec2& block) const {
    const glm::uvec2 i = cells_of(level, block.x, pyramid_.size().columns),
                     j = cells_of(level, block.y, pyramid_.size().rows);
    GridSpan span = between(span_, 0, pyramid_.x_m()[i.x], pyramid_.x_m()[i.y]);
    span = between(span, 1, pyramid_.y_m()[j.x], pyramid_.y_m()[j.y]);
    const HeightPyramid::Heights& heights = pyramid_.heights(level, block);
    return span.any() ? between(span, 2, static_cast<double>(heights.low), static_cast<double>(heights.high)) : span;
  }

  void visit_cells(const glm::uvec2& block) {
    const glm::uvec2 i = cells_of(0, block.x, pyramid_.size().columns), j = cells_of(0, block.y, pyramid_.size().rows);
    for (std::uint32_t y = 0; y < j.y - j.x; ++y) {
      const std::uint32_t row = flip_.y != 0 ? j.y - 1 - y : j.x + y;
      const GridSpan in_row = between(span_, 1, pyramid_.y_m()[row], pyramid_.y_m()[row + 1]);
      if (!in_row.any()) continue;
      const double a = ray_.from.x + in_row.first * ray_.way.x, b = ray_.from.x + in_row.last * ray_.way.x;
      const double low = std::min(a, b) - 2 * ray_.pad.x, high = std::max(a, b) + 2 * ray_.pad.x;
      for (std::uint32_t x = 0; x < i.y - i.x; ++x) {
        const std::uint32_t column = flip_.x != 0 ? i.y - 1 - x : i.x + x;
        const auto [left, right] = std::minmax(pyramid_.x_m()[column], pyramid_.x_m()[column + 1]);
        if (left > high || right < low) continue;
        const GridSpan in_cell = between(in_row, 0, pyramid_.x_m()[column], pyramid_.x_m()[column + 1]);
        if (in_cell.any()) visit_cell(column, row, in_cell);
      }
    }
  }

  void visit_cell(std::uint32_t column, std::uint32_t row, const GridSpan& span) {
    const std::size_t columns = pyramid_.size().columns;
    const glm::vec3* const above = &mesh_.positions[row * columns + column];
    const glm::vec3* const below = above + columns;
    const auto [low, high] = std::minmax({above[0].z, above[1].z, below[0].z, below[1].z});
    if (!between(span, 2, static_cast<double>(low), static_cast<double>(high)).any()) return;
    span_.last = try_cell_(static_cast<std::uint32_t>(row * (columns - 1) + column));
  }

  const Mesh& mesh_;
  const HeightPyramid& pyramid_;
  const GridRay& ray_;
  GridSpan span_;
  const TryCell& try_cell_;
  glm::dvec3 per_way_{0};
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
