// The walls of an occupancy grid as one mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// Cells of a map, rows from the bottom.
struct OccupancyGrid {
  std::uint32_t columns = 0, rows = 0;
  std::vector<bool> occupied;  ///< [row * columns + column]

  bool at(std::int64_t column, std::int64_t row) const {
    return column >= 0 && row >= 0 && column < columns && row < rows &&
           occupied[static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column)];
  }
};

/// A building of 50,000 rooms has fewer. They take 250 MB; a picture of some kilobytes could have 500 times as many.
inline constexpr std::size_t kMaxWallRectangles = 1'000'000;

/// The surface of all occupied cells, from z = 0 to `height_m`; the lower left corner of the first cell is the origin.
/// Sides between two occupied cells are left out, and sides in one line are one rectangle. Tops and bottoms are covered
/// by rectangles: runs of a row, joined with equal runs of the rows above. Normals are flat; a texture covers a square
/// as wide as the walls are high. Empty: there are more than kMaxWallRectangles rectangles.
std::optional<Mesh> grid_walls(const OccupancyGrid& grid, double cell_m, double height_m);

}  // namespace simvis
