// The mesh of occupied cells: its sides, counted cell by cell.
#include "import/grid_map/cell_walls.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>
#include <tuple>

TEST_SUITE_BEGIN("maps");

namespace simvis {
namespace {

using Cell = std::tuple<int, int, int>;

// The sides of a mesh of cells of 1 m: for each cell and direction that a rectangle covers, as often as it does.
std::multiset<std::tuple<Cell, int, int>> sides_of(const Mesh& mesh) {
  std::multiset<std::tuple<Cell, int, int>> sides;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 6) {
    const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[i + k]]); };
    const glm::dvec3 low = glm::min(at(0), at(2)), high = glm::max(at(0), at(2));
    const glm::dvec3 normal(mesh.attributes[mesh.indices[i]].normal);
    CHECK(glm::dot(glm::cross(at(1) - at(0), at(2) - at(0)), normal) > 0);
    CHECK(glm::dot(glm::cross(at(4) - at(3), at(5) - at(3)), normal) > 0);
    CHECK(glm::length(glm::cross(high - low, normal)) == doctest::Approx(glm::length(high - low)));
    int axis = 0;
    while (normal[axis] == 0) ++axis;
    const int way = normal[axis] > 0 ? 1 : -1;
    glm::ivec3 first(low), end(high);
    end[axis] = first[axis] += way > 0 ? -1 : 0;
    ++end[axis];
    for (int x = first.x; x < end.x; ++x) {
      for (int y = first.y; y < end.y; ++y) {
        for (int z = first.z; z < end.z; ++z) sides.emplace(Cell{x, y, z}, axis, way);
      }
    }
  }
  return sides;
}

void check_walls(const glm::uvec3& size, const std::set<Cell>& cells) {
  CAPTURE(size.x);
  CAPTURE(size.y);
  CellGrid grid(size);
  for (const auto& [x, y, z] : cells) grid.occupy(glm::uvec3(x, y, z));
  std::multiset<std::tuple<Cell, int, int>> expected;
  for (const Cell& cell : cells) {
    const auto beside = [&](int axis, int way) {
      glm::ivec3 other(std::get<0>(cell), std::get<1>(cell), std::get<2>(cell));
      other[axis] += way;
      return cells.contains({other.x, other.y, other.z});
    };
    const bool is_enclosed = beside(0, -1) && beside(0, 1) && beside(1, -1) && beside(1, 1);
    for (int axis = 0; axis < 3; ++axis) {
      for (const int way : {-1, 1}) {
        if (!beside(axis, way) || (is_enclosed && axis == 0 && way < 0)) expected.emplace(cell, axis, way);
      }
    }
  }
  const std::optional<Mesh> mesh = cell_walls(grid, glm::dvec3(1), 1);
  REQUIRE(mesh);
  const bool is_same = sides_of(*mesh) == expected;  // the sets are long
  CHECK(is_same);
}

TEST_CASE("each side between an occupied and a free cell is covered once, in grids of any size") {
  std::mt19937_64 random(5);
  for (const glm::uvec3& size : {glm::uvec3(1, 1, 1), {7, 5, 3}, {63, 4, 2}, {64, 3, 3}, {65, 4, 1}, {129, 3, 2}}) {
    for (const unsigned share : {2u, 5u, 100u}) {
      std::set<Cell> cells;
      for (unsigned x = 0; x < size.x; ++x) {
        for (unsigned y = 0; y < size.y; ++y) {
          for (unsigned z = 0; z < size.z; ++z) {
            if (random() % share != 0) cells.emplace(x, y, z);
          }
        }
      }
      check_walls(size, cells);
    }
  }
}

TEST_CASE("blocks are six rectangles, also where their rows are longer than a word") {
  for (const glm::uvec3& size : {glm::uvec3(1, 1, 1), {64, 2, 3}, {65, 1, 1}, {200, 2, 2}}) {
    CAPTURE(size.x);
    CellGrid grid(size + 2u);
    for (std::uint32_t x = 0; x < size.x; ++x) {
      for (std::uint32_t y = 0; y < size.y; ++y) {
        for (std::uint32_t z = 0; z < size.z; ++z) grid.occupy({x + 1, y + 1, z + 1});
      }
    }
    const std::optional<Mesh> mesh = cell_walls(grid, {0.5, 0.25, 2}, 1);
    REQUIRE(mesh);
    CHECK(mesh->indices.size() == 6 * 6);
    CHECK(mesh->bounds_min == glm::vec3(0.5, 0.25, 2));
    CHECK(mesh->bounds_max == glm::vec3(glm::dvec3(size + 1u) * glm::dvec3(0.5, 0.25, 2)));
  }
}

TEST_CASE("walls of more rectangles than the limit are not made") {
  CellGrid grid({2048, 1024, 1});
  for (std::uint32_t x = 0; x < 2048; ++x) {
    for (std::uint32_t y = x % 2; y < 1024; y += 2) grid.occupy({x, y, 0});
  }
  CHECK_FALSE(cell_walls(grid, glm::dvec3(1), 1));
}

}  // namespace
}  // namespace simvis
