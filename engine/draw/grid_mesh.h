// Meshes whose triangles are a regular grid of heights.
//
// The vertices of such a mesh stand in rows and columns: x depends on the column alone and y on the row alone, and both
// ascend or descend from each to the next. Each cell of four vertices is two triangles, which meet between the first
// vertex of its first row and the last vertex of its last row: height_map() of scenegraph/height_map.h makes such
// meshes for every format. The triangles of the cell in column i and row j are the primitives 2 c and 2 c + 1 with
// c = j (columns - 1) + i.
#pragma once

#include <cstdint>
#include <optional>

#include <simvis/mesh.h>

namespace simvis {

/// The numbers of vertices along x and y.
struct GridSize {
  std::uint32_t columns = 0, rows = 0;

  bool operator==(const GridSize&) const = default;
};

/// Grids with fewer cells are taken for any other mesh: packets of rays share the tests of a tree of boxes and take
/// half the time. At this size the tree takes 23 MB and half a second to make; that of 4096 x 4096 heights takes 750 MB
/// and minutes.
inline constexpr std::uint32_t kMinGridCells = 1u << 18;

/// The size of a mesh that is a regular grid of at least kMinGridCells cells; empty for any other mesh. Of other meshes
/// hardly more than the first triangles are read.
std::optional<GridSize> find_grid(const Mesh& mesh);

}  // namespace simvis
