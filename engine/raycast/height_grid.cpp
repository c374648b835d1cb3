#include "engine/raycast/height_grid.h"

#include <algorithm>
#include <limits>

namespace simvis {
namespace {

std::vector<double> x_of_columns(const Mesh& mesh, const GridSize& size) {
  std::vector<double> x_m(size.columns);
  for (std::uint32_t column = 0; column < size.columns; ++column) x_m[column] = mesh.positions[column].x;
  return x_m;
}

std::vector<double> y_of_rows(const Mesh& mesh, const GridSize& size) {
  std::vector<double> y_m(size.rows);
  for (std::uint32_t row = 0; row < size.rows; ++row) y_m[row] = mesh.positions[std::size_t{row} * size.columns].y;
  return y_m;
}

std::uint32_t halves(std::uint32_t count, std::uint32_t shift) { return (count + (1u << shift) - 1) >> shift; }

void include(HeightPyramid::Heights& heights, const HeightPyramid::Heights& other) {
  heights = {std::min(heights.low, other.low), std::max(heights.high, other.high)};
}

constexpr HeightPyramid::Heights kNoHeights{std::numeric_limits<float>::infinity(),
                                            -std::numeric_limits<float>::infinity()};

}  // namespace

HeightPyramid::HeightPyramid(const Mesh& mesh, const GridSize& size)
    : size_(size), x_m_(x_of_columns(mesh, size)), y_m_(y_of_rows(mesh, size)) {
  levels_.push_back(smallest_blocks(mesh, size));
  while (levels_.back().heights.size() > 1) levels_.push_back(halved(levels_.back()));
}

// The vertices on the border of a block belong to both blocks beside it.
HeightPyramid::Level HeightPyramid::smallest_blocks(const Mesh& mesh, const GridSize& size) {
  Level level;
  level.blocks = {halves(size.columns - 1, kBlockShift), halves(size.rows - 1, kBlockShift)};
  level.heights.assign(std::size_t{level.blocks.x} * level.blocks.y, kNoHeights);
  const glm::vec3* vertex = mesh.positions.data();
  constexpr std::uint32_t kInBlock = (1u << kBlockShift) - 1;
  for (std::uint32_t row = 0; row < size.rows; ++row) {
    const std::uint32_t below = std::min(row >> kBlockShift, level.blocks.y - 1);
    const std::uint32_t above = row > 0 && (row & kInBlock) == 0 ? (row >> kBlockShift) - 1 : below;
    for (std::uint32_t column = 0; column < size.columns; ++column, ++vertex) {
      const std::uint32_t right = std::min(column >> kBlockShift, level.blocks.x - 1);
      const std::uint32_t left = column > 0 && (column & kInBlock) == 0 ? (column >> kBlockShift) - 1 : right;
      for (std::uint32_t y = above; y <= below; ++y) {
        for (std::uint32_t x = left; x <= right; ++x) {
          include(level.heights[std::size_t{y} * level.blocks.x + x], {vertex->z, vertex->z});
        }
      }
    }
  }
  return level;
}

HeightPyramid::Level HeightPyramid::halved(const Level& level) {
  Level half;
  half.blocks = {halves(level.blocks.x, 1), halves(level.blocks.y, 1)};
  half.heights.assign(std::size_t{half.blocks.x} * half.blocks.y, kNoHeights);
  for (std::uint32_t y = 0; y < level.blocks.y; ++y) {
    for (std::uint32_t x = 0; x < level.blocks.x; ++x) {
      include(half.heights[std::size_t{y / 2} * half.blocks.x + x / 2],
              level.heights[std::size_t{y} * level.blocks.x + x]);
    }
  }
  return half;
}

std::size_t HeightPyramid::memory() const {
  std::size_t bytes = (x_m_.size() + y_m_.size()) * sizeof(double);
  for (const Level& level : levels_) bytes += level.heights.size() * sizeof(Heights);
  return bytes;
}

}  // namespace simvis
