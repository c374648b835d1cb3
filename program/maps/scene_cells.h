// The cells of a regular grid through which surfaces of a scene pass: ground truth for maps.
//
// What counts    visible shapes, whatever they look like: glass and what a mask cuts out too. Not: materials of opacity
//                0, lines, points that no beam hits, Gaussian splats, and items that are left out.
// Exactness      triangles as they stand in the draw list; round shapes, points of clouds and planes as rays meet them.
//                program/maps/cell_overlap.h says when a surface passes through a cell. Rounding counts up to
//                a 64th of a cell.
// Cells          Cell (i, j, k) reaches from i to i + 1 times the resolution along each axis of the world, so that maps
//                of one resolution have the same cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include <simvis/draw_list.h>

namespace simvis {

/// The largest number of cells of a map.
inline constexpr std::size_t kMaxMapCells = std::size_t{1} << 28;

/// What a map says of a cell.
enum class CellState : std::int8_t { unknown = -1, free = 0, occupied = 1 };

/// What to map. Frame: world.
struct MapDesc {
  double resolution_m = 0;  ///< side of a cell, above 0
  bool is_flat = false;     ///< one layer of cells, which is `heights_m` high; otherwise cells are cubes
  /// The lowest and the highest height; needed by a flat map, otherwise those of the shapes.
  std::optional<glm::dvec2> heights_m{};
  struct Area {
    glm::dvec2 low{0}, high{0};
  };
  std::optional<Area> area_m{};  ///< empty: that of the shapes. It becomes larger, up to whole cells;
                                 ///< heights stay those of all shapes
  /// Cells that cannot be reached from here, from cell to cell through sides, are unknown; empty: all are free that are
  /// not occupied. A flat map ignores z.
  std::optional<glm::dvec3> start_m{};
};

struct SceneCells {
  double resolution_m = 0;
  glm::ivec3 first{0};              ///< number of the first cell: its lowest corner is `first` times the resolution;
                                    ///< z of a flat map is 0
  glm::uvec3 size{0};               ///< numbers of cells
  glm::dvec3 origin_m{0},           ///< of the lowest corner of the first cell
      cell_m{0};                    ///< size of a cell
  std::vector<CellState> states{};  ///< [(z * size.y + y) * size.x + x]

  std::size_t index(const glm::uvec3& c) const { return (std::size_t{c.z} * size.y + c.y) * size.x + c.x; }
  CellState at(const glm::uvec3& c) const { return states[index(c)]; }
};

/// The cells of the scene as the draw list has it. `left_out` is as long as `list.items`, or empty.
/// Throws InputError if there is no shape, the map would have more than kMaxMapCells cells or cells farther than 2^30
/// cells from the origin, or the start lies outside of the map or in an occupied cell.
SceneCells map_scene(const DrawList& list, const std::vector<bool>& left_out, const MapDesc& desc);

}  // namespace simvis
