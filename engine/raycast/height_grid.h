// Meshes whose triangles are a regular grid of heights, and what rays need of them in place of a tree of boxes.
//
// The vertices of such a mesh stand in rows and columns: x depends on the column alone and y on the row alone, and both
// ascend or descend from each to the next. Each cell of four vertices is two triangles, which meet between the first
// vertex of its first row and the last vertex of its last row: height_map() of scenegraph/height_map.h makes such
// meshes for every format. The triangles of the cell in column i and row j are the primitives 2 c and 2 c + 1 with
// c = j (columns - 1) + i.
//
// Where a cell lies follows from its number, so that nothing but the lowest and the highest height of each block of
// cells has to be kept: less than a byte for each vertex.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// The numbers of vertices along x and y.
struct GridSize {
  std::uint32_t columns = 0, rows = 0;

  bool operator==(const GridSize&) const = default;
};

/// Grids with fewer cells get a tree of boxes, in which packets of rays share the tests and take half the time. At this
/// size it takes 23 MB and half a second to make; that of 4096 x 4096 heights takes 750 MB and minutes.
inline constexpr std::uint32_t kMinGridCells = 1u << 18;

/// The size of a mesh that is a regular grid of at least kMinGridCells cells; empty for any other mesh. Of other meshes
/// hardly more than the first triangles are read.
std::optional<GridSize> find_grid(const Mesh& mesh);

/// Lowest and highest heights of blocks of cells: blocks of 4 x 4 cells, then of 8 x 8 cells, and so on up to one
/// block.
class HeightPyramid {
 public:
  struct Heights {
    float low = 0, high = 0;
  };
  static constexpr std::uint32_t kBlockShift = 2;  ///< the smallest blocks have 2^kBlockShift cells on a side

  HeightPyramid(const Mesh& mesh, const GridSize& size);

  const GridSize& size() const { return size_; }
  const std::vector<double>& x_m() const { return x_m_; }  ///< of the columns, in the frame of the mesh
  const std::vector<double>& y_m() const { return y_m_; }  ///< of the rows
  std::uint32_t levels() const { return static_cast<std::uint32_t>(levels_.size()); }

  /// The blocks of a level along x and y; level 0 has the smallest blocks.
  glm::uvec2 blocks(std::uint32_t level) const { return levels_[level].blocks; }
  const Heights& heights(std::uint32_t level, glm::uvec2 block) const {
    const Level& of = levels_[level];
    return of.heights[std::size_t{block.y} * of.blocks.x + block.x];
  }

  /// In bytes.
  std::size_t memory() const;

 private:
  struct Level {
    glm::uvec2 blocks{0};
    std::vector<Heights> heights;  // row by row
  };
  static Level smallest_blocks(const Mesh& mesh, const GridSize& size);
  static Level halved(const Level& level);

  GridSize size_;
  std::vector<double> x_m_, y_m_;
  std::vector<Level> levels_;
};

}  // namespace simvis
