#include "engine/draw/grid_mesh.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace simvis {
namespace {

// Primitives, two for each cell, are numbered in 32 bits.
constexpr std::size_t kMaxGridCells = std::numeric_limits<std::uint32_t>::max() / 2;

// The number of columns that the first cell says.
std::optional<GridSize> size_by_first_cell(const Mesh& mesh) {
  if (mesh.topology != Topology::triangles || mesh.surface || mesh.indices.size() < 6) return {};
  const std::size_t vertices = mesh.positions.size(), columns = mesh.indices[1];
  if (columns < 2 || vertices % columns != 0 || vertices / columns < 2) return {};
  const std::size_t rows = vertices / columns, cells = (columns - 1) * (rows - 1);
  if (cells < kMinGridCells || cells > kMaxGridCells || mesh.indices.size() != 6 * cells) return {};
  return GridSize{static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows)};
}

bool has_cells(const std::vector<std::uint32_t>& indices, const GridSize& size) {
  const std::uint32_t* index = indices.data();
  for (std::uint32_t row = 0; row + 1 < size.rows; ++row) {
    for (std::uint32_t column = 0; column + 1 < size.columns; ++column, index += 6) {
      const std::uint32_t a = row * size.columns + column, b = a + size.columns;
      if (index[0] != a || index[1] != b || index[2] != b + 1 || index[3] != a || index[4] != b + 1 ||
          index[5] != a + 1) {
        return false;
      }
    }
  }
  return true;
}

// Whether `count` values ascend from each to the next, or descend.
template <class Value>
bool is_monotonic(std::uint32_t count, const Value& value) {
  const bool ascends = value(count - 1) > value(0);
  for (std::uint32_t i = 0; i + 1 < count; ++i) {
    if (ascends ? !(value(i) < value(i + 1)) : !(value(i) > value(i + 1))) return false;
  }
  return true;
}

bool stands_in_rows(const Mesh& mesh, const GridSize& size) {
  const glm::vec3* vertex = mesh.positions.data();
  for (std::uint32_t row = 0; row < size.rows; ++row) {
    const float y = vertex->y;
    for (std::uint32_t column = 0; column < size.columns; ++column, ++vertex) {
      if (vertex->x != mesh.positions[column].x || vertex->y != y) return false;
    }
  }
  return is_monotonic(size.columns, [&](std::uint32_t column) { return mesh.positions[column].x; }) &&
         is_monotonic(size.rows, [&](std::uint32_t row) { return mesh.positions[std::size_t{row} * size.columns].y; });
}

}  // namespace

std::optional<GridSize> find_grid(const Mesh& mesh) {
  const std::optional<GridSize> size = size_by_first_cell(mesh);
  return size && has_cells(mesh.indices, *size) && stands_in_rows(mesh, *size) ? size : std::nullopt;
}

}  // namespace simvis
