#include "import/grid_map/grid_walls.h"

#include <array>
#include <map>
#include <utility>

namespace simvis {
namespace {

class GridWalls {
 public:
  GridWalls(const OccupancyGrid& grid, double cell_m, double height_m)
      : grid_(grid), cell_m_(cell_m), height_m_(height_m) {
    mesh_.name = "grid_map";
  }

  std::optional<Mesh> run() {
    for (std::uint32_t row = 0; row < grid_.rows; ++row) {
      add_sides_along_x(row, -1);
      add_sides_along_x(row, 1);
    }
    for (std::uint32_t column = 0; column < grid_.columns; ++column) {
      add_sides_along_y(column, -1);
      add_sides_along_y(column, 1);
    }
    add_levels();
    if (rectangles_ > kMaxWallRectangles) return std::nullopt;
    compute_bounds(mesh_);
    return std::move(mesh_);
  }

 private:
  // Sides of one row that face along -y (`way` -1) or y (1).
  void add_sides_along_x(std::int64_t row, std::int64_t way) {
    const double y = way > 0 ? x_of(row + 1) : x_of(row);
    for_each_run(
        grid_.columns, [&](std::int64_t i) { return grid_.at(i, row) && !grid_.at(i, row + way); },
        [&](std::int64_t first, std::int64_t end) {
          const double from = x_of(way < 0 ? first : end), to = x_of(way < 0 ? end : first);
          add_quad({glm::dvec3(from, y, 0), {to, y, 0}, {to, y, height_m_}, {from, y, height_m_}}, {0, way, 0});
        });
  }

  void add_sides_along_y(std::int64_t column, std::int64_t way) {
    const double x = way > 0 ? x_of(column + 1) : x_of(column);
    for_each_run(
        grid_.rows, [&](std::int64_t i) { return grid_.at(column, i) && !grid_.at(column + way, i); },
        [&](std::int64_t first, std::int64_t end) {
          const double from = x_of(way > 0 ? first : end), to = x_of(way > 0 ? end : first);
          add_quad({glm::dvec3(x, from, 0), {x, to, 0}, {x, to, height_m_}, {x, from, height_m_}}, {way, 0, 0});
        });
  }

  void add_levels() {
    std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> open;  // runs, and the rows in which they begin
    for (std::int64_t row = 0; row <= grid_.rows; ++row) {
      std::map<std::pair<std::int64_t, std::int64_t>, std::int64_t> here;
      for_each_run(
          grid_.columns, [&](std::int64_t i) { return grid_.at(i, row); },
          [&](std::int64_t first, std::int64_t end) { here.emplace(std::pair(first, end), row); });
      for (const auto& [run, begin] : open) {
        const auto same = here.find(run);
        if (same == here.end()) {
          add_level(run.first, begin, run.second, row);
        } else {
          same->second = begin;
        }
      }
      open = std::move(here);
    }
  }

  void add_level(std::int64_t left, std::int64_t low, std::int64_t right, std::int64_t high) {
    const double x0 = x_of(left), x1 = x_of(right), y0 = x_of(low), y1 = x_of(high), z = height_m_;
    add_quad({glm::dvec3(x0, y0, z), {x1, y0, z}, {x1, y1, z}, {x0, y1, z}}, {0, 0, 1});
    add_quad({glm::dvec3(x0, y1, 0), {x1, y1, 0}, {x1, y0, 0}, {x0, y0, 0}}, {0, 0, -1});
  }

  template <typename Test, typename Add>
  static void for_each_run(std::int64_t count, const Test& test, const Add& add) {
    for (std::int64_t i = 0; i < count;) {
      const std::int64_t first = i;
      while (i < count && test(i)) ++i;
      if (i > first) add(first, i);
      if (i < count && i == first) ++i;
    }
  }

  double x_of(std::int64_t line) const { return static_cast<double>(line) * cell_m_; }

  void add_quad(const std::array<glm::dvec3, 4>& corners, const glm::dvec3& normal) {
    if (++rectangles_ > kMaxWallRectangles) return;
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    for (const glm::dvec3& corner : corners) {
      VertexAttributes attributes;
      attributes.normal = glm::vec3(normal);
      const glm::dvec2 on_side = normal.z != 0   ? glm::dvec2(corner)
                                 : normal.x != 0 ? glm::dvec2(corner.y, corner.z)
                                                 : glm::dvec2(corner.x, corner.z);
      attributes.uv[0] = attributes.uv[1] = glm::vec2(on_side.x / height_m_, 1 - on_side.y / height_m_);
      mesh_.positions.emplace_back(corner);
      mesh_.attributes.push_back(attributes);
    }
    mesh_.indices.insert(mesh_.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
  }

  const OccupancyGrid& grid_;
  double cell_m_, height_m_;
  Mesh mesh_;
  std::size_t rectangles_ = 0;
};

}  // namespace

std::optional<Mesh> grid_walls(const OccupancyGrid& grid, double cell_m, double height_m) {
  return GridWalls(grid, cell_m, height_m).run();
}

}  // namespace simvis
