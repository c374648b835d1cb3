// What the importers of grids share: occupied cells as the content of a part.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/glm.hpp>

#include <simvis/part_importer.h>
#include "import/grid_map/cell_walls.h"

namespace simvis {

/// Sizes of a cell that files may have.
inline constexpr double kMinCell_m = 1e-6, kMaxCell_m = 1e6;

/// Throws InputError naming the file if a grid of this size would have more than kMaxGridCells cells, filled up more
/// than kMaxFilledCells, or more than kMaxAxisCells along an axis. `what` says which cells these are, such as "its
/// occupied cells span".
void check_grid_size(const std::filesystem::path& file, const char* what, const glm::dvec3& cells);

/// The cells of a grid, and where they stand.
struct PlacedGrid {
  CellGrid cells;
  glm::dvec3 cell_m{1};            ///< size of a cell
  double texture_m = 1;            ///< side of the square that a texture covers
  glm::dmat4 part_from_grid{1.0};  ///< moves the lowest corner of the first cell, which is the origin of the grid
};

/// One shape with the walls of the grid. Throws InputError naming the file if no cell is occupied, or if the walls have
/// too many rectangles.
PartContent grid_part(const std::filesystem::path& file, const PlacedGrid& grid, ContentPool& pool);

}  // namespace simvis
