// The surface of occupied cells as one mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// The largest number of cells of a grid: a square of 16384 cells, 32 MB.
inline constexpr std::size_t kMaxGridCells = std::size_t{1} << 28;

/// Cells of a regular grid; z is up. A map has one layer.
class CellGrid {
 public:
  /// No cell is occupied. `size` has at most kMaxGridCells cells.
  explicit CellGrid(const glm::uvec3& size)
      : size_(size), occupied_(std::size_t{size.x} * size.y * std::size_t{size.z}) {}

  const glm::uvec3& size() const { return size_; }
  /// Cells outside of the grid are free.
  bool at(const glm::ivec3& cell) const {
    const glm::uvec3 c(cell);  // a negative number becomes a large one
    return c.x < size_.x && c.y < size_.y && c.z < size_.z && occupied_[index(c)];
  }
  /// The cell is within the grid.
  void occupy(const glm::uvec3& cell) { occupied_[index(cell)] = true; }

 private:
  std::size_t index(const glm::uvec3& c) const { return (std::size_t{c.z} * size_.y + c.y) * size_.x + c.x; }

  glm::uvec3 size_;
  std::vector<bool> occupied_;
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
