// The surface of occupied cells as one mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// The largest number of cells of a grid: a square of 16384 cells on a side.
inline constexpr std::size_t kMaxGridCells = std::size_t{1} << 28;

/// The largest number of cells after rows along x are filled up to whole words of 64 cells. They take 128 MB.
inline constexpr std::size_t kMaxFilledCells = 4 * kMaxGridCells;

/// The largest number of cells along an axis, far above that of an OctoMap, 65536: cell_walls() keeps a number for
/// each.
inline constexpr std::size_t kMaxAxisCells = std::size_t{1} << 20;

/// Cells of a regular grid; z is up. A map has one layer.
class CellGrid {
 public:
  /// No cell is occupied. `size` is within kMaxGridCells, kMaxFilledCells and kMaxAxisCells.
  explicit CellGrid(const glm::uvec3& size)
      : size_(size),
        row_words_((size.x + kWordBits - 1) / kWordBits),
        words_(std::size_t{row_words_} * size.y * size.z) {}

  const glm::uvec3& size() const { return size_; }
  /// The cell is within the grid.
  void occupy(const glm::uvec3& cell) {
    words_[row_index(cell.y, cell.z) + cell.x / kWordBits] |= std::uint64_t{1} << cell.x % kWordBits;
  }
  /// A bit for each cell of a row along x, the lowest of the first word first; bits behind the row are 0. Empty: the
  /// row is not within the grid.
  std::span<const std::uint64_t> row(int y, int z) const {
    const auto row_y = static_cast<std::uint32_t>(y), row_z = static_cast<std::uint32_t>(z);  // negative: a large one
    if (row_y >= size_.y || row_z >= size_.z) return {};
    return std::span(words_).subspan(row_index(row_y, row_z), row_words_);
  }

  static constexpr std::uint32_t kWordBits = 64;

 private:
  std::size_t row_index(std::uint32_t y, std::uint32_t z) const { return (std::size_t{z} * size_.y + y) * row_words_; }

  glm::uvec3 size_;
  std::uint32_t row_words_;
  std::vector<std::uint64_t> words_;
};

/// A building of 50,000 rooms has fewer. They take 250 MB; a picture of some kilobytes could have 500 times as many.
inline constexpr std::size_t kMaxWallRectangles = 1'000'000;

/// The surface of all occupied cells, of `cell_m` along each axis; the lowest corner of the first cell is the origin.
/// Sides between two occupied cells are left out. Sides in one plane are covered by rectangles: runs of a row, joined
/// with equal runs of the rows beside it. Normals are flat; a texture covers a square of `texture_m`.
///
/// A cell with four occupied cells around it keeps its side towards -x: no sensor sees it there, but maps of the mesh
/// show which cells are occupied.
///
/// Empty: there are more than kMaxWallRectangles rectangles.
std::optional<Mesh> cell_walls(const CellGrid& grid, const glm::dvec3& cell_m, double texture_m);

}  // namespace simvis
