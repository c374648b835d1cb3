// What rays need of a regular grid of heights (engine/draw/grid_mesh.h) in place of a tree of boxes: where a cell
// lies follows from its number, so that nothing but the lowest and the highest height of each block of cells has to be
// kept, less than a byte for each vertex.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include <simvis/mesh.h>
#include "engine/draw/grid_mesh.h"

namespace simvis {

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
