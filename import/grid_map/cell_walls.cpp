#include "import/grid_map/cell_walls.h"

#include <array>
#include <utility>

namespace simvis {
namespace {

// Occupied sides in one row of a slice, and the row in which equal ones begin.
struct Run {
  int first = 0, end = 0, begin_row = 0;
};

class CellWalls {
 public:
  CellWalls(const CellGrid& grid, const glm::dvec3& cell_m, double texture_m)
      : grid_(grid), cell_m_(cell_m), texture_m_(texture_m) {
    mesh_.name = "grid_map";
  }

  std::optional<Mesh> run() {
    for (const int axis : {1, 0, 2}) {
      for (const int way : {-1, 1}) {
        for (int slice = 0; slice < static_cast<int>(grid_.size()[axis]); ++slice) add_slice(axis, way, slice);
      }
    }
    if (rectangles_ > kMaxWallRectangles) return std::nullopt;
    compute_bounds(mesh_);
    return std::move(mesh_);
  }

 private:
  // Sides of the cells of one slice that face along the axis (`way` 1) or against it (-1).
  void add_slice(int axis, int way, int slice) {
    const int rows = static_cast<int>(grid_.size()[(axis + 2) % 3]);
    std::vector<Run> open;
    for (int row = 0; row <= rows && rectangles_ <= kMaxWallRectangles; ++row) {
      std::vector<Run> here;
      if (row < rows) here = runs_of_row(axis, way, slice, row);
      auto same = here.begin();
      for (const Run& run : open) {
        while (same != here.end() && same->first < run.first) ++same;
        if (same != here.end() && same->first == run.first && same->end == run.end) {
          same->begin_row = run.begin_row;
        } else {
          add_rectangle(axis, way, way > 0 ? slice + 1 : slice, {run.first, run.begin_row}, {run.end, row});
        }
      }
      open = std::move(here);
    }
  }

  std::vector<Run> runs_of_row(int axis, int way, int slice, int row) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3, cells = static_cast<int>(grid_.size()[u]);
    std::vector<Run> runs;
    glm::ivec3 cell;
    cell[axis] = slice;
    cell[v] = row;
    bool in_run = false;
    for (int i = 0; i < cells; ++i) {
      cell[u] = i;
      const bool has = has_side(cell, axis, way);
      if (has && !in_run) runs.push_back({i, i, row});
      if (has) runs.back().end = i + 1;
      in_run = has;
    }
    return runs;
  }

  bool has_side(const glm::ivec3& cell, int axis, int way) const {
    if (!grid_.at(cell)) return false;
    glm::ivec3 beside = cell;
    beside[axis] += way;
    return !grid_.at(beside) || (axis == 0 && way < 0 && is_enclosed(cell));
  }

  bool is_enclosed(const glm::ivec3& c) const {
    return grid_.at({c.x - 1, c.y, c.z}) && grid_.at({c.x + 1, c.y, c.z}) && grid_.at({c.x, c.y - 1, c.z}) &&
           grid_.at({c.x, c.y + 1, c.z});
  }

  // A rectangle from `low` to `high` along the two axes that follow `axis` in cyclic order, in cells.
  void add_rectangle(int axis, int way, int line, const glm::ivec2& low, const glm::ivec2& high) {
    if (++rectangles_ > kMaxWallRectangles) return;
    const auto corner = [&](int along_u, int along_v) {
      glm::ivec3 cell;
      cell[axis] = line;
      cell[(axis + 1) % 3] = along_u;
      cell[(axis + 2) % 3] = along_v;
      return glm::dvec3(cell) * cell_m_;
    };
    std::array corners = {corner(low.x, low.y), corner(high.x, low.y), corner(high.x, high.y), corner(low.x, high.y)};
    if (way < 0) std::swap(corners[1], corners[3]);
    glm::vec3 normal(0);
    normal[axis] = static_cast<float>(way);
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (const glm::dvec3& position : corners) add_vertex(position, normal, axis);
    mesh_.indices.insert(mesh_.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
  }

  // A texture stands upright on sides.
  void add_vertex(const glm::dvec3& position, const glm::vec3& normal, int axis) {
    const glm::dvec2 on_side(axis == 0 ? position.y : position.x, axis == 2 ? position.y : position.z);
    VertexAttributes attributes;
    attributes.normal = normal;
    attributes.uv[0] = attributes.uv[1] = glm::vec2(on_side.x / texture_m_, 1 - on_side.y / texture_m_);
    mesh_.positions.emplace_back(position);
    mesh_.attributes.push_back(attributes);
  }

  const CellGrid& grid_;
  glm::dvec3 cell_m_;
  double texture_m_;
  Mesh mesh_;
  std::size_t rectangles_ = 0;
};

}  // namespace

std::optional<Mesh> cell_walls(const CellGrid& grid, const glm::dvec3& cell_m, double texture_m) {
  return CellWalls(grid, cell_m, texture_m).run();
}

}  // namespace simvis
