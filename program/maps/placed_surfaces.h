// The surfaces of an item of a draw list, in the frame of a grid of cells.
#pragma once

#include <functional>

#include <simvis/draw_list.h>
#include "program/maps/cell_overlap.h"

namespace simvis {

/// The grid of cells in the world.
struct CellFrame {
  glm::dvec3 origin_m{0},  ///< of the lowest corner of the first cell
      cell_m{1};           ///< size of a cell
  /// Number of cells: planes without an end are cut to these. 0: such planes are left out.
  glm::uvec3 size{0};
};

/// What takes the surfaces: each with a box around it, as far as it comes in by more than its rounding.
struct SurfaceVisitor {
  std::function<void(const CellTriangle&, const CellBox&)> triangle;
  std::function<void(const CellSolid&, const CellBox&)> solid;
  std::function<void(const CellDisc&, const CellBox&)> disc;
};

/// Visits the surfaces of an item that scene_cells.h counts, triangles and discs settled.
void visit_surfaces(const DrawList& list, const DrawItem& item, const CellFrame& frame, const SurfaceVisitor& visitor);

/// The same with one function for all kinds of surfaces.
template <typename Action>
void for_each_placed_surface(const DrawList& list, const DrawItem& item, const CellFrame& frame, const Action& action) {
  visit_surfaces(list, item, frame, {action, action, action});
}

}  // namespace simvis
