// The cells through which surfaces of scenes pass, against closed forms and dense samples.
#include "program/maps/scene_cells.h"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <set>
#include <string>
#include <tuple>

#include <simvis/simulation.h>
#include "engine/draw/round_mesh.h"
#include "simvis/built_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("maps");

namespace simvis {
namespace {

using Cell = std::tuple<int, int, int>;
using Cells = std::set<Cell>;

DrawList list_of(const std::string& commands) {
  Simulation simulation = Simulation::from_string(commands);
  read_all_content(simulation);
  simulation.step();
  return simulation.diagnostics().draw_list();
}

// The numbers of the occupied cells in the world.
Cells occupied(const SceneCells& map) {
  Cells cells;
  for (std::uint32_t z = 0; z < map.size.z; ++z) {
    for (std::uint32_t y = 0; y < map.size.y; ++y) {
      for (std::uint32_t x = 0; x < map.size.x; ++x) {
        const glm::ivec3 cell = map.first + glm::ivec3(x, y, z);
        if (map.at({x, y, z}) == CellState::occupied) cells.emplace(cell.x, cell.y, cell.z);
      }
    }
  }
  return cells;
}

Cells voxels_of(const DrawList& list, double resolution_m) {
  return occupied(map_scene(list, {}, {.resolution_m = resolution_m}));
}

// The cells of a box in which a function is true.
Cells cells_where(const glm::ivec3& low, const glm::ivec3& high, const std::function<bool(glm::ivec3)>& is_in) {
  Cells cells;
  for (int x = low.x; x < high.x; ++x) {
    for (int y = low.y; y < high.y; ++y) {
      for (int z = low.z; z < high.z; ++z) {
        if (is_in({x, y, z})) cells.emplace(x, y, z);
      }
    }
  }
  return cells;
}

// The outer cells of a block.
Cells shell(const glm::ivec3& low, const glm::ivec3& high) {
  return cells_where(low, high, [&](const glm::ivec3& c) {
    return glm::any(glm::equal(c, low)) || glm::any(glm::equal(c, high - 1));
  });
}

std::string box_at(const std::string& size, const std::string& pose) {
  return "<part name='BOX' insert_at='ROOT' shape='box' size='" + size + "' pose_offset='" + pose + "'/>";
}

TEST_CASE("a box whose sides lie in boundaries of cells occupies its outer cells") {
  // None of these decimals is a number of double or float.
  CHECK(voxels_of(list_of(box_at("0.5 0.3 0.7", "0.85 -0.35 0.35 0 0 0")), 0.1) == shell({6, -5, 0}, {11, -2, 7}));
  CHECK(voxels_of(list_of(box_at("0.5 0.3 0.7", "0.85 -0.35 0.35 0 0 90")), 0.1) == shell({7, -6, 0}, {10, -1, 7}));
  CHECK(voxels_of(list_of(box_at("100.1 0.3 0.1", "50.05 0.15 1000.05 0 0 0")), 0.1) ==
        shell({0, 0, 10000}, {1001, 3, 10001}));
  // A box of less than a cell within one, and one that reaches into 3 x 2 x 2.
  CHECK(voxels_of(list_of(box_at("0.04 0.04 0.04", "0.05 0.05 0.05 0 0 0")), 0.1) == Cells{{0, 0, 0}});
  CHECK(voxels_of(list_of(box_at("0.24 0.12 0.12", "0.15 0 0 0 0 0")), 0.1) == shell({0, -1, -1}, {3, 1, 1}));
}

TEST_CASE("far from the origin cells are as exact as doubles are") {
  CHECK(voxels_of(list_of(box_at("0.5 0.5 0.5", "1000000.25 -2000000.25 0.25 0 0 0")), 0.125) ==
        shell({8000000, -16000004, 0}, {8000004, -16000000, 4}));
}

TEST_CASE("meshes with coordinates that are rounded by more than a cell are mapped as they are") {
  // Floats near 10^6 are 1/16 apart, and cells are 1/20.
  DrawList list = list_of(box_at("0.5 0.5 0.5", "0 0 0 0 0 0"));
  Mesh far = *list.meshes.at(list.items.at(0).mesh);
  for (glm::vec3& position : far.positions) position.x += 1e6f;
  compute_bounds(far);
  list.meshes[list.items[0].mesh] = std::make_shared<const Mesh>(far);
  const Cells cells = voxels_of(list, 0.05);
  CHECK(cells == shell({19999995, -5, -5}, {20000005, 5, 5}));
}

TEST_CASE("mirrored boxes occupy the same cells as boxes that are not") {
  DrawList list = list_of(box_at("0.5 0.3 0.7", "0 0 0 0 0 0"));
  for (const double way : {1.0, -1.0}) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::dmat4 matrix(1);
      matrix[axis] *= way;
      list.world_from_node[list.items.at(0).transform] = glm::translate(glm::dmat4(1), {0.25, 0.15, 0.35}) * matrix;
      CHECK(voxels_of(list, 0.1) == shell({0, 0, 0}, {5, 3, 7}));
    }
  }
}

TEST_CASE("a tilted wall occupies the cells that its line crosses") {
  // From (0, 0) to (8, 3) along 8 y = 3 x, without thickness: it crosses the cells with 8 y < 3 (x + 1) and
  // 8 (y + 1) > 3 x. The product keeps the slope exact, so that it touches corners of cells at its ends alone.
  const std::string wall = "<part name='W' insert_at='ROOT' shape='plane' size='1 1'/>";
  DrawList list = list_of(wall);
  list.world_from_node[list.items.at(0).transform] = glm::dmat4(8, 3, 0, 0, 0, 0, 1, 0, 3, -8, 0, 0, 4, 1.5, 0.5, 1);
  CHECK(voxels_of(list, 1) == cells_where({0, 0, 0}, {8, 3, 1}, [](const glm::ivec3& c) {
          return 8 * c.y < 3 * (c.x + 1) && 8 * (c.y + 1) > 3 * c.x;
        }));
  // The diagonal touches the cells beside it at corners.
  list.world_from_node[list.items.at(0).transform] = glm::dmat4(5, 5, 0, 0, 0, 0, 1, 0, 1, -1, 0, 0, 2.5, 2.5, 0.5, 1);
  CHECK(voxels_of(list, 1) == Cells{{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {3, 3, 0}, {4, 4, 0}});
}

TEST_CASE("a sphere occupies the cells with a corner outside of it and a point inside") {
  constexpr double kRadius_m = 0.73, kSide_m = 0.1;
  const glm::dvec3 center(0.31, -0.17, 0.55);
  const Cells cells = voxels_of(
      list_of("<part name='B' insert_at='ROOT' shape='sphere' radius='0.73' pose_offset='0.31 -0.17 0.55 0 0 0'/>"),
      kSide_m);
  CHECK(cells == cells_where(glm::ivec3(-20), glm::ivec3(20), [&](const glm::ivec3& c) {
          const glm::dvec3 low = glm::dvec3(c) * kSide_m - center, high = low + kSide_m;
          const glm::dvec3 nearest = glm::clamp(glm::dvec3(0), low, high), farthest = glm::max(-low, high);
          return glm::length(nearest) < kRadius_m && glm::length(farthest) > kRadius_m;
        }));
  CHECK(cells.size() > 800);
}

TEST_CASE("round shapes are mapped as they are, not by the flat sides that cameras draw") {
  // 0.1 % of the radius lie outside of the drawn sides: a plane of cells at that height is entered by the shape alone.
  const DrawList list = list_of(
      "<part name='C' insert_at='ROOT' shape='cylinder' radius='1.0005' length='0.5' pose_offset='0 0 0.25 0 0 3'/>");
  CHECK(voxels_of(list, 0.5).contains({2, 0, 0}));
  DrawList drawn = list;
  Mesh flat = *drawn.meshes.at(drawn.items.at(0).mesh);
  flat.surface.reset();
  drawn.meshes[drawn.items[0].mesh] = std::make_shared<const Mesh>(flat);
  CHECK_FALSE(voxels_of(drawn, 0.5).contains({2, 0, 0}));
}

// The cells of points that lie densely on the surfaces of a list, at least so many cells' thousandths inside a cell.
Cells sampled(const DrawList& list, double resolution_m) {
  constexpr int kSteps = 160;
  constexpr double kInside = 1e-3;
  Cells cells;
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    const auto add = [&](const glm::dvec3& position) {
      const glm::dvec3 point =
          glm::dvec3(list.world_from_node[item.transform] * glm::dvec4(position, 1)) / resolution_m;
      const glm::dvec3 cell = glm::floor(point), rest = point - cell;
      if (glm::any(glm::lessThan(rest, glm::dvec3(kInside))) ||
          glm::any(glm::greaterThan(rest, glm::dvec3(1 - kInside))))
        return;
      cells.emplace(static_cast<int>(cell.x), static_cast<int>(cell.y), static_cast<int>(cell.z));
    };
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const auto corner = [&](std::size_t k) {
        const glm::dvec3 position(mesh.positions[mesh.indices[i + k]]);
        if (!mesh.surface) return position;
        REQUIRE(mesh.surface->kind == SurfaceKind::sphere);
        return position;
      };
      const glm::dvec3 a = corner(0), b = corner(1) - a, c = corner(2) - a;
      const int steps = mesh.surface ? 12 : kSteps;
      for (int u = 0; u <= steps; ++u) {
        for (int v = 0; u + v <= steps; ++v) {
          glm::dvec3 position = a + (double(u) * b + double(v) * c) / double(steps);
          if (mesh.surface) position *= mesh.surface->radius_m / glm::length(position);
          add(position);
        }
      }
    }
  }
  return cells;
}

TEST_CASE("cells that dense samples of the surfaces lie in are occupied, and hardly any others") {
  const DrawList list = list_of(
      box_at("0.7 0.3 0.9", "0.2 0.1 0.6 20 30 40") +
      "<part name='BALL' insert_at='ROOT' shape='sphere' radius='0.4' pose_offset='-0.8 0.3 0.2 0 0 0'/>"
      "<part name='WALL' insert_at='ROOT' shape='wall' points='-1 -1, 1 -0.7, 1.2 1' height='1' thickness='0.13'"
      " doors='0.8 0.5 0.7'/>"
      "<part name='FLOOR' insert_at='ROOT' shape='plane' size='2 3' pose_offset='0.03 0.04 0.05 1 2 3'/>");
  const Cells mapped = voxels_of(list, 0.11), found = sampled(list, 0.11);
  for (const Cell& cell : found) CHECK(mapped.contains(cell));
  CHECK(found.size() > 1500);
  // The samples of a triangle are below 1/100 cell apart: they miss corners of cells that are cut by less.
  CHECK(static_cast<double>(mapped.size() - found.size()) < 0.02 * static_cast<double>(mapped.size()));
}

TEST_CASE("a flat map shows what lies in its band, and no floor below it") {
  const DrawList list = list_of(
      "<part name='FLOOR' insert_at='ROOT' shape='plane' size='2 2'/>"
      "<part name='TABLE' insert_at='ROOT' shape='box' size='0.5 0.5 0.1' pose_offset='0.25 0.25 0.75 0 0 0'/>" +
      box_at("0.1 0.1 0.7", "-0.45 -0.45 0.35 0 0 0"));
  const auto map = [&](double low, double high) {
    return occupied(map_scene(list, {}, {.resolution_m = 0.1, .is_flat = true, .heights_m = {{low, high}}}));
  };
  const Cells post{{-5, -5, 0}}, top = cells_where({0, 0, 0}, {5, 5, 1}, [](const glm::ivec3&) { return true; });
  CHECK(map(0, 0.7) == post);  // the floor faces up and the table's lower side down: both belong to cells outside
  Cells both = post;
  both.insert(top.begin(), top.end());
  CHECK(map(0.1, 1) == both);
  CHECK(map(0.7, 0.75) == top);
  CHECK(map(0.72, 0.78) == cells_where({0, 0, 0}, {5, 5, 1}, [](const glm::ivec3& c) {
          return c.x == 0 || c.x == 4 || c.y == 0 || c.y == 4;  // within the table there are its sides alone
        }));
  CHECK(map(0.9, 2).empty());
  CHECK(map(-0.1, 0).size() == 20 * 20);
}

TEST_CASE("the area of a map is that of the shapes or the given one, in whole cells") {
  const DrawList list = list_of(box_at("0.5 0.3 0.7", "0.85 -0.35 0.35 0 0 0"));
  const SceneCells around = map_scene(list, {}, {.resolution_m = 0.1});
  CHECK(around.first == glm::ivec3(6, -5, 0));
  CHECK(around.size == glm::uvec3(5, 3, 7));
  CHECK(around.origin_m == glm::dvec3(6 * 0.1, -5 * 0.1, 0));
  const MapDesc given{
      .resolution_m = 0.1, .is_flat = true, .heights_m = {{0.1, 0.4}}, .area_m = {{{-0.3, -0.7}, {0.95, 0.31}}}};
  const SceneCells map = map_scene(list, {}, given);
  CHECK(map.first == glm::ivec3(-3, -7, 0));
  CHECK(map.size == glm::uvec3(13, 11, 1));
  CHECK(map.cell_m == glm::dvec3(0.1, 0.1, 0.4 - 0.1));
  CHECK(map.origin_m.z == 0.1);
  CHECK(occupied(map) ==
        cells_where({6, -5, 0}, {10, -2, 1}, [](const glm::ivec3& c) { return c.x == 6 || c.y == -5 || c.y == -3; }));
}

TEST_CASE("planes without an end reach through the whole map and do not make it larger") {
  DrawList list = list_of(box_at("0.5 0.3 0.7", "0.85 -0.35 0.35 0 0 0"));
  Mesh plane;
  plane.surface = ExactSurface{.kind = SurfaceKind::plane, .axis = 2};
  list.meshes.push_back(std::make_shared<const Mesh>(plane));
  DrawItem item = list.items.at(0);
  item.mesh = static_cast<std::uint32_t>(list.meshes.size() - 1);
  item.transform = static_cast<std::uint32_t>(list.world_from_node.size());
  list.world_from_node.push_back(glm::translate(glm::dmat4(1), {1e4, 0, 0.25}));
  list.items.push_back(item);
  Cells expected = shell({6, -5, 0}, {11, -2, 7});
  expected.merge(cells_where({6, -5, 2}, {11, -2, 3}, [](const glm::ivec3&) { return true; }));
  CHECK(voxels_of(list, 0.1) == expected);
  list.items.erase(list.items.begin());
  CHECK(contains(error_of([&] { voxels_of(list, 0.1); }), "the scene has no shape that has an end"));
}

TEST_CASE("points of clouds count as the spheres or discs that rays meet, others do not") {
  DrawList list = list_of(box_at("0.5 0.3 0.7", "0 0 0 0 0 0"));
  Mesh cloud;
  cloud.topology = Topology::points;
  cloud.positions = {{0.5, 0.5, 0.5}, {3.5, 0.5, 0.5}};
  cloud.attributes.resize(2);  // normals along z
  cloud.indices = {0, 1};
  const auto map = [&](std::optional<ExactSurface> surface) {
    cloud.surface = surface;
    list.meshes[list.items.at(0).mesh] = std::make_shared<const Mesh>(cloud);
    const MapDesc desc{.resolution_m = 1, .heights_m = {{-1, 2}}, .area_m = {{{-2, -2}, {6, 3}}}};
    return occupied(map_scene(list, {}, desc));
  };
  CHECK(map({}).empty());
  CHECK(map(ExactSurface{.kind = SurfaceKind::sphere, .radius_m = 0.4}) == Cells{{0, 0, 0}, {3, 0, 0}});
  // Of radius 0.6: the cells that share a side with the middle one, whose corners lie outside of the sphere too.
  CHECK(map(ExactSurface{.kind = SurfaceKind::sphere, .radius_m = 0.6}).size() == 14);
  CHECK(map(ExactSurface{.kind = SurfaceKind::disc, .radius_m = 0.6}).size() == 10);
}

TEST_CASE("hidden shapes, shapes of opacity 0 and those that are left out are not mapped, glass is") {
  const std::string box = box_at("1 1 1", "0.5 0.5 0.5 0 0 0");
  DrawList list =
      list_of(box + "<part name='OTHER' insert_at='ROOT' shape='box' size='1 1 1' pose_offset='5.5 0.5 0.5 0 0 0'/>");
  REQUIRE(list.items.size() == 2);
  CHECK(voxels_of(list, 1) == Cells{{0, 0, 0}, {5, 0, 0}});
  CHECK(occupied(map_scene(list, {true, false}, {.resolution_m = 1})).size() == 1);
  list.items[0].visible = false;
  CHECK(voxels_of(list, 1).size() == 1);
  list.items[0].visible = true;
  for (const float opacity : {0.0f, 0.1f}) {
    Material glass = *list.materials[list.items[0].material];
    glass.opacity = opacity;
    list.materials.push_back(std::make_shared<const Material>(glass));
    list.items[0].material = static_cast<std::uint32_t>(list.materials.size() - 1);
    CHECK(voxels_of(list, 1).size() == (opacity > 0 ? 2 : 1));
  }
}

TEST_CASE("cells that cannot be reached from a start are unknown") {
  // A room with a closed cupboard and a door that is one cell wide.
  const DrawList list = list_of(
      "<part name='ROOM' insert_at='ROOT' shape='wall' points='0 0, 4 0, 4 4, 0 4, 0 0' height='2' thickness='0.2'/>"
      "<part name='CUPBOARD' insert_at='ROOT' shape='box' size='1 1 2' pose_offset='2 2 1 0 0 0'/>");
  MapDesc desc{.resolution_m = 0.1, .is_flat = true, .heights_m = {{0.1, 1}}, .area_m = {{{-1, -1}, {5, 5}}}};
  const auto count = [&](const SceneCells& map, CellState state) { return std::ranges::count(map.states, state); };
  const SceneCells all = map_scene(list, {}, desc);
  CHECK(count(all, CellState::unknown) == 0);
  CHECK(count(all, CellState::free) == 3600 - static_cast<long>(occupied(all).size()));
  desc.start_m = {0.5, 0.5, 0};
  const SceneCells reached = map_scene(list, {}, desc);
  CHECK(occupied(reached) == occupied(all));
  // 38 x 38 cells within the walls, without the 10 x 10 of the cupboard.
  CHECK(count(reached, CellState::free) == 38 * 38 - 10 * 10);
  CHECK(reached.at({10 + 20, 10 + 20, 0}) == CellState::unknown);  // in the cupboard
  CHECK(reached.at({0, 0, 0}) == CellState::unknown);              // outside
  const auto refused = [&](const glm::dvec3& start) {
    desc.start_m = start;
    return error_of([&] { map_scene(list, {}, desc); });
  };
  CHECK(contains(refused({9, 0, 0}), "the start 9, 0 lies outside of the map"));
  CHECK(contains(refused({4.05, 2, 0}), "the start 4.05, 2 lies in an occupied cell"));
}

TEST_CASE("the search from a start takes less memory than the map") {
  if (sanitized()) return test::skip(test::kNotSanitized);  // freed memory is kept
  const DrawList list = list_of(box_at("1 1 1", "0.5 0.5 0.5 0 0 0"));
  constexpr int kSide = 2048;
  MapDesc desc{.resolution_m = 1, .is_flat = true, .heights_m = {{0.1, 1}}, .area_m = {{{0, 0}, {kSide, kSide}}}};
  const auto largest_kB = [] {
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    return used.ru_maxrss;
  };
  const SceneCells all = map_scene(list, {}, desc);
  const long before_kB = largest_kB();
  desc.start_m = {kSide - 0.5, kSide - 0.5, 0};
  const SceneCells reached = map_scene(list, {}, desc);
  CHECK(reached.states == all.states);
  // The states of the second map are a byte for each of 2^22 cells, 4096 kB. The front of the search is a diagonal of
  // at most 2 kSide cells of 12 bytes, 48 kB; pages and the allocator may round that up to as much again as the states.
  constexpr long kMaxGrowth_kB = 2 * 4096;
  CHECK(largest_kB() - before_kB < kMaxGrowth_kB);
}

TEST_CASE("maps with too many cells are refused with their size") {
  const DrawList list = list_of(box_at("5000 5000 10", "0 0 0 0 0 0"));
  const std::string error = error_of([&] { voxels_of(list, 0.01); });
  CHECK(contains(error, "the map would have 500000 x 500000 x 1000 cells of 0.01 m from -2500, -2500 on"));
  CHECK(contains(error, "expected at most 268435456 cells"));
  CHECK(contains(error_of([&] { voxels_of(list_of(box_at("1 1 1", "1e12 0 0 0 0 0")), 0.1); }), "expected at most"));
}

}  // namespace
}  // namespace simvis
