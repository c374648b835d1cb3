#include "import/grid_map/cell_walls.h"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>
#include <utility>

namespace simvis {
namespace {

using Row = std::vector<std::uint64_t>;

// Sides in a line, from cell to cell of one row; `slice` is the layer of cells that has them. Equal runs of the rows
// before it are one rectangle with this one, from `begin_row` on.
struct Run {
  int slice = 0, first = 0, end = 0, begin_row = 0;

  bool comes_before(const Run& other) const {
    return std::tie(slice, first, end) < std::tie(other.slice, other.first, other.end);
  }
};

// The first cell from `from` on whose bit is `value`; the number of bits if there is none.
int next_cell(const Row& row, int from, bool value) {
  constexpr auto kBits = CellGrid::kWordBits;
  std::size_t word = static_cast<std::size_t>(from) / kBits;
  if (word >= row.size()) return static_cast<int>(row.size() * kBits);
  const auto bits = [&](std::size_t i) { return value ? row[i] : ~row[i]; };
  std::uint64_t left = bits(word) & (~std::uint64_t{0} << static_cast<unsigned>(from) % kBits);
  while (left == 0 && ++word < row.size()) left = bits(word);
  return static_cast<int>(word * kBits) + (word < row.size() ? std::countr_zero(left) : 0);
}

class CellWalls {
 public:
  CellWalls(const CellGrid& grid, const glm::dvec3& cell_m, double texture_m)
      : grid_(grid),
        cell_m_(cell_m),
        texture_m_(texture_m),
        size_(grid.size()),
        words_((grid.size().x + CellGrid::kWordBits - 1) / CellGrid::kWordBits) {
    mesh_.name = "grid_map";
  }

  std::optional<Mesh> run() {
    for (const int way : {-1, 1}) add_sides_along_x(1, way);
    for (const int way : {-1, 1}) add_sides_along_y(way);
    for (const int way : {-1, 1}) add_sides_along_x(2, way);
    if (rectangles_ > kMaxWallRectangles) return std::nullopt;
    compute_bounds(mesh_);
    return std::move(mesh_);
  }

 private:
  // Sides across y or z, in runs along x.
  void add_sides_along_x(int axis, int way) {
    const int across = 3 - axis;
    for (int slice = 0; slice < size_[axis]; ++slice) {
      std::vector<Run> open;
      for (int row = 0; row <= size_[across] && rectangles_ <= kMaxWallRectangles; ++row) {
        std::vector<Run> here;
        if (row < size_[across]) {
          const Row sides = axis == 1 ? sides_of(axis, way, slice, row) : sides_of(axis, way, row, slice);
          for (int x = 0; (x = next_cell(sides, x, true)) < size_.x;) {
            const int end = next_cell(sides, x, false);
            here.push_back({slice, x, end, row});
            x = end;
          }
        }
        join(open, std::move(here), axis, way, row);
      }
    }
  }

  // Sides across x, in runs along y.
  void add_sides_along_y(int way) {
    std::vector<Run> open;
    std::vector<int> begin(static_cast<std::size_t>(size_.x));
    for (int z = 0; z <= size_.z && rectangles_ <= kMaxWallRectangles; ++z) {
      std::vector<Run> here;
      Row before(words_);
      for (int y = 0; z < size_.z && y <= size_.y; ++y) {
        const Row sides = sides_of(0, way, y, z);
        Row changes(words_);
        for (std::size_t i = 0; i < words_; ++i) changes[i] = before[i] ^ sides[i];
        for (int x = 0; (x = next_cell(changes, x, true)) < size_.x; ++x) {
          int& first = begin[static_cast<std::size_t>(x)];
          if (next_cell(sides, x, true) != x) here.push_back({x, first, y, z});
          first = y;
        }
        before = sides;
      }
      std::ranges::sort(here, [](const Run& a, const Run& b) { return a.comes_before(b); });
      join(open, std::move(here), 0, way, z);
    }
  }

  // The cells of a row, of which none lies outside of the grid.
  Row cells_of(int y, int z) const {
    const std::span<const std::uint64_t> row = grid_.row(y, z);
    return row.empty() ? Row(words_) : Row(row.begin(), row.end());
  }

  // For each cell of a row, whether the one beside it along x is occupied.
  Row beside(const Row& row, int way) const {
    constexpr auto kLast = CellGrid::kWordBits - 1;
    Row moved(words_);
    for (std::size_t i = 0; i < words_; ++i) {
      const std::uint64_t next = i + 1 < words_ ? row[i + 1] : 0, last = i > 0 ? row[i - 1] : 0;
      moved[i] = way > 0 ? row[i] >> 1 | next << kLast : row[i] << 1 | last >> kLast;
    }
    return moved;
  }

  // The cells of a row that have a side towards `way` along the axis.
  Row sides_of(int axis, int way, int y, int z) const {
    Row row = cells_of(y, z);
    if (next_cell(row, 0, true) >= size_.x) return row;  // no cell is occupied
    const Row other = axis == 0 ? beside(row, way) : axis == 1 ? cells_of(y + way, z) : cells_of(y, z + way);
    const bool keeps_enclosed = axis == 0 && way < 0;
    Row enclosed(words_);
    if (keeps_enclosed) enclosed = enclosed_of(row, y, z);
    for (std::size_t i = 0; i < words_; ++i) row[i] &= ~other[i] | enclosed[i];
    return row;
  }

  // The cells of a row with four occupied ones around them.
  Row enclosed_of(Row row, int y, int z) const {
    for (const Row& other : {beside(row, -1), beside(row, 1), cells_of(y - 1, z), cells_of(y + 1, z)}) {
      for (std::size_t i = 0; i < words_; ++i) row[i] &= other[i];
    }
    return row;
  }

  // Goes on with the rectangles that have an equal run in the next row, and adds the others. Both lists are sorted.
  void join(std::vector<Run>& open, std::vector<Run> here, int axis, int way, int row) {
    auto same = here.begin();
    for (const Run& run : open) {
      while (same != here.end() && same->comes_before(run)) ++same;
      if (same != here.end() && !run.comes_before(*same)) {
        same->begin_row = run.begin_row;
      } else {
        add_rectangle(axis, way, run, row);
      }
    }
    open = std::move(here);
  }

  // The run and its rows up to `end_row`.
  void add_rectangle(int axis, int way, const Run& run, int end_row) {
    if (++rectangles_ > kMaxWallRectangles) return;
    const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    const auto corner = [&](int along_u, int along_v) {
      glm::ivec3 cell;
      cell[axis] = way > 0 ? run.slice + 1 : run.slice;
      cell[u] = along_u;
      cell[v] = along_v;
      return glm::dvec3(cell) * cell_m_;
    };
    std::array corners = {corner(run.first, run.begin_row), corner(run.end, run.begin_row), corner(run.end, end_row),
                          corner(run.first, end_row)};
    const bool is_forward = axis != 1;  // u, v and the axis are a right-handed frame
    if ((way > 0) != is_forward) std::swap(corners[1], corners[3]);
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
  glm::ivec3 size_;
  std::size_t words_;  // of a row
  Mesh mesh_;
  std::size_t rectangles_ = 0;
};

}  // namespace

std::optional<Mesh> cell_walls(const CellGrid& grid, const glm::dvec3& cell_m, double texture_m) {
  return CellWalls(grid, cell_m, texture_m).run();
}

}  // namespace simvis
