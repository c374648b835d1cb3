// Rays through regular grids of heights: the hits of a tree of boxes over the same triangles, to the bit; the surface
// of the picture, within the bound. By hand: SIMVIS_TEST_GRID_RAYS=1000000.
#include "engine/raycast/height_grid.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "scenegraph/height_map.h"
#include "tests/support/infinity.h"
#include "tests/support/long_count.h"
#include "tests/support/ray_casting.h"
#include "tests/support/reference_raycast.h"

TEST_SUITE_BEGIN("engine/raycast");

namespace simvis {
namespace {

constexpr std::uint32_t kColumns = 530, kRows = 501;
const glm::dvec2 kSize_m(10.1, 9.7);
constexpr double kLow_m = -0.7, kHigh_m = 1.9;

// Hills with noise, a flat part, and a step.
HeightPicture hills(std::uint32_t columns, std::uint32_t rows, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> noise(0, 0.05f);
  HeightPicture picture{columns, rows, {}};
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      const double x = 6.0 * column / columns, y = 5.0 * row / rows;
      const auto hill = static_cast<float>(0.4 + 0.3 * std::sin(x) * std::cos(y) + (x > 3 && y < 2 ? 0.2 : 0));
      picture.values.push_back(x > 4 && y > 3 ? 0.5f : hill + noise(random));
    }
  }
  return picture;
}

HeightMap hilly_map() { return height_map(hills(kColumns, kRows, 7), kSize_m, kLow_m, kHigh_m); }

// A triangle without an area is hit by no ray, and with it the mesh is no regular grid.
Mesh with_tree(Mesh mesh) {
  mesh.indices.insert(mesh.indices.end(), {0, 0, 0});
  return mesh;
}

DrawList list_of(std::shared_ptr<const Mesh> mesh, const glm::dmat4& world_from_mesh) {
  DrawList list;
  add_item(list, Mesh(), world_from_mesh);
  list.meshes[0] = std::move(mesh);
  return list;
}

// The same surface as a grid and as a mesh with a tree, and casters that keep what rays need of both.
struct GridAndTree {
  std::shared_ptr<const Mesh> grid = std::make_shared<const Mesh>(hilly_map().mesh),
                              tree = std::make_shared<const Mesh>(with_tree(hilly_map().mesh));
  DrawList of_grid = list_of(grid, glm::dmat4(1)), of_tree = list_of(tree, glm::dmat4(1));
  RayEngine first = host_engine(), second = host_engine();

  GridAndTree() {
    first.cast_one(of_grid, {0, 0, -1}, at(0, 0, 5));
    second.cast_one(of_tree, {0, 0, -1}, at(0, 0, 5));
  }
};

const GridAndTree& surfaces() {
  static const GridAndTree both;
  return both;
}

// Where a grid may stand, and from where it may be seen.
std::vector<glm::dmat4> places(std::mt19937& random) {
  glm::dmat4 sheared(1);
  sheared[1][0] = 0.7;
  sheared[2][1] = -0.4;
  return {glm::dmat4(1),
          random_pose(random, 5),
          glm::scale(random_pose(random, 5), {-1, 1, 2}),
          glm::scale(random_pose(random, 5), {1e-2, 3, 0.5}),
          random_pose(random, 3) * sheared,
          at(1e6, -7e5, 3e5) * random_pose(random, 5),
          glm::scale(at(1, 2, 3), {1, 1, 0}),
          glm::scale(at(0.1, 0.2, 0), {0, 1, 1})};
}

glm::dmat4 sensor_near(const glm::dmat4& place, std::mt19937& random) {
  const double reaches_m[] = {0.5, 4, 40};
  glm::dmat4 pose = random_pose(random, 0);
  pose[3] = place * glm::dvec4(reaches_m[random() % 3] * random_direction(random), 1);
  return pose;
}

// Along the axes of the sensor too, which are those of the grid in the first place.
std::vector<glm::dvec3> directions_from(const DrawList& list, const glm::dmat4& pose, std::size_t count,
                                        std::mt19937& random) {
  std::vector<glm::dvec3> directions = directions_into(list, pose, count, random);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double way : {-1.0, 1.0}) {
      directions.emplace_back(0);
      directions.back()[axis] = way;
      directions.push_back(glm::transpose(glm::dmat3(pose)) * directions.back());
    }
  }
  return directions;
}

// To a point that is not near an edge of the first item's triangles.
glm::dvec3 direction_inside(const DrawList& list, const glm::dmat4& pose, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.1, 1);
  const Mesh& mesh = *list.meshes[list.items[0].mesh];
  const std::size_t triangle = random() % (mesh.indices.size() / 3);
  const glm::dvec3 weights(unit(random), unit(random), unit(random));
  glm::dvec3 point(0);
  for (int k = 0; k < 3; ++k) {
    point += weights[k] * glm::dvec3(mesh.positions[mesh.indices[3 * triangle + static_cast<std::size_t>(k)]]);
  }
  point /= weights.x + weights.y + weights.z;
  return glm::normalize(
      glm::dvec3(rigid_inverse(pose) * (list.world_from_node[list.items[0].transform] * glm::dvec4(point, 1))));
}

std::size_t hits_of(const std::vector<RayHit>& hits) {
  return static_cast<std::size_t>(
      std::ranges::count_if(hits, [](const RayHit& hit) { return hit.range_m < kInfinity; }));
}

}  // namespace

TEST_CASE("regular grids are found, and no other meshes") {
  const Mesh grid = hilly_map().mesh;
  CHECK(find_grid(grid) == GridSize{kColumns, kRows});
  CHECK(find_grid(mesh_in_place(hilly_map())) == GridSize{kColumns, kRows});
  CHECK_FALSE(find_grid(with_tree(grid)));
  CHECK_FALSE(find_grid(sphere_mesh(1)));
  CHECK_FALSE(find_grid(Mesh{}));
  CHECK_FALSE(find_grid(height_map(hills(512, 513, 1), {1, 1}, 0, 1).mesh));  // 511 x 512 cells are too few
  CHECK(find_grid(height_map(hills(513, 513, 1), {1, 1}, 0, 1).mesh));
  const auto changed = [&](const auto& change) {
    Mesh mesh = grid;
    change(mesh);
    return find_grid(mesh);
  };
  CHECK_FALSE(changed([](Mesh& m) { std::swap(m.indices[m.indices.size() - 1], m.indices[m.indices.size() - 2]); }));
  CHECK_FALSE(changed([](Mesh& m) { m.positions[2000].x += 0.01f; }));
  CHECK_FALSE(changed([](Mesh& m) { m.positions[2000].y += 0.01f; }));
  CHECK_FALSE(changed([](Mesh& m) {
    for (std::uint32_t row = 0; row < kRows; ++row) m.positions[row * kColumns + 5].x = m.positions[0].x - 1;
  }));
  CHECK_FALSE(changed([](Mesh& m) { m.topology = Topology::points; }));
  CHECK(changed([](Mesh& m) { m.positions[2000].z += 0.01f; }));
  CHECK(changed([](Mesh& m) {
    for (glm::vec3& p : m.positions) p = {-p.x, -p.y, p.z};
  }));
}

TEST_CASE("the pyramid contains the heights of each block, with those of its border") {
  for (const glm::uvec2 size : {glm::uvec2(65, 65), {66, 67}, {90, 61}, {2, 5000}}) {
    const Mesh mesh = height_map(hills(size.x, size.y, 3), {2, 2}, 0, 1).mesh;
    const HeightPyramid pyramid(mesh, {size.x, size.y});
    CAPTURE(size.x);
    std::size_t blocks = 0;
    for (std::uint32_t level = 0; level < pyramid.levels(); ++level) {
      const std::uint32_t side = 1u << (HeightPyramid::kBlockShift + level);
      const glm::uvec2 count = pyramid.blocks(level);
      for (std::uint32_t y = 0; y < count.y; ++y) {
        for (std::uint32_t x = 0; x < count.x; ++x, ++blocks) {
          float low = 1e9f, high = -1e9f;
          for (std::uint32_t row = y * side; row <= std::min((y + 1) * side, size.y - 1); ++row) {
            for (std::uint32_t column = x * side; column <= std::min((x + 1) * side, size.x - 1); ++column) {
              low = std::min(low, mesh.positions[row * size.x + column].z);
              high = std::max(high, mesh.positions[row * size.x + column].z);
            }
          }
          const HeightPyramid::Heights& heights = pyramid.heights(level, {x, y});
          REQUIRE(heights.low == low);
          REQUIRE(heights.high == high);
        }
      }
    }
    CHECK(pyramid.blocks(pyramid.levels() - 1) == glm::uvec2(1));
    CHECK(blocks > 200);
    CHECK(pyramid.memory() < std::size_t{8} * size.x * size.y);
  }
}

TEST_CASE("rays through a grid hit what they hit in a tree over its triangles, to the bit") {
  const RayEngine engine = each_engine();
  std::mt19937 random(11);
  const std::shared_ptr<const Mesh>&grid = surfaces().grid, &tree = surfaces().tree;
  const auto rays = static_cast<std::size_t>(count_of("SIMVIS_TEST_GRID_RAYS", 20'000));
  std::size_t cast = 0, hits = 0;
  while (cast < rays) {
    for (const glm::dmat4& place : places(random)) {
      const DrawList of_grid = list_of(grid, place), of_tree = list_of(tree, place);
      const glm::dmat4 pose = sensor_near(place, random);
      const std::vector<glm::dvec3> directions = directions_from(of_grid, pose, 400, random);
      const std::vector<RayHit> expected = host_engine().cast(of_tree, pose, directions);
      CHECK(engine.cast(of_grid, pose, directions) == expected);
      cast += directions.size();
      hits += hits_of(expected);
    }
  }
  CHECK(hits > cast / 3);
}

TEST_CASE("rays with origins of their own, and rays behind the nearest hit, are those of the tree") {
  std::mt19937 random(12);
  const std::shared_ptr<const Mesh>&grid = surfaces().grid, &tree = surfaces().tree;
  std::size_t behind = 0;
  for (int round = 0; round < 3; ++round) {
    for (const glm::dmat4& place : places(random)) {
      const DrawList of_grid = list_of(grid, place), of_tree = list_of(tree, place);
      const glm::dmat4 pose = sensor_near(place, random);
      const std::vector<glm::dvec3> directions = directions_from(of_grid, pose, 400, random);
      std::vector<glm::dvec3> origins_m;
      for (std::size_t i = 0; i < directions.size(); ++i) origins_m.push_back(0.02 * random_direction(random));
      const RayEngine a = host_engine(), b = host_engine();
      std::vector<RayHit> hits(directions.size()), expected(directions.size());
      a.caster->set_world(of_grid);
      b.caster->set_world(of_tree);
      a.caster->cast_from(pose, origins_m, directions, hits);
      b.caster->cast_from(pose, origins_m, directions, expected);
      CHECK(hits == expected);
      std::vector<double> t_min_m;
      b.caster->cast(pose, directions, expected);
      for (const RayHit& hit : expected) t_min_m.push_back(hit.range_m < kInfinity ? hit.range_m : 0);
      a.caster->cast(pose, directions, hits, t_min_m);
      b.caster->cast(pose, directions, expected, t_min_m);
      CHECK(hits == expected);
      behind += hits_of(expected);
    }
  }
  CHECK(behind > 200);
}

TEST_CASE("rays through a grid hit what a test of every triangle finds") {
  std::mt19937 random(13);
  const DrawList list = list_of(surfaces().grid, random_pose(random, 2));
  std::size_t hits = 0;
  for (int pose_number = 0; pose_number < 2; ++pose_number) {
    const glm::dmat4 pose = sensor_near(list.world_from_node[list.items[0].transform], random);
    const reference::RayCaster truth(list, rigid_inverse(pose));
    const RayEngine engine = host_engine();
    for (int i = 0; i < 40; ++i) {
      const glm::dvec3 direction = direction_inside(list, pose, random);
      const RayHit hit = engine.cast_one(list, direction, pose);
      // The reference forgives distances of 1e-12 from an edge.
      constexpr double kRange_rel = 1e-9;
      CHECK(std::abs(hit.range_m - truth.cast_all(direction).range_m) <= kRange_rel * hit.range_m);
      hits += hit.range_m < kInfinity;
    }
  }
  CHECK(hits > 50);
}

// The bound is that of the surface of the picture, whose sizes are no floats.
TEST_CASE("hits lie on the surface that the picture and its size describe, within their bounds") {
  using Vector = glm::vec<3, long double>;
  std::mt19937 random(14);
  const HeightPicture picture = hills(kColumns, kRows, 7);
  const HeightMap map = height_map(picture, kSize_m, kLow_m, kHigh_m);
  const auto vertex = [&](std::uint32_t number) -> Vector {
    const std::uint32_t column = number % kColumns, row = number / kColumns;
    const auto x = static_cast<long double>(kSize_m.x), y = static_cast<long double>(kSize_m.y);
    return {x * column / (kColumns - 1) - x / 2, y / 2 - y * row / (kRows - 1),
            kLow_m + static_cast<long double>(picture.values[number]) *
                         (static_cast<long double>(kHigh_m) - static_cast<long double>(kLow_m))};
  };
  std::size_t hits = 0, beyond = 0;
  double worst_rel = 0;
  for (int pose_number = 0; pose_number < 40; ++pose_number) {
    const glm::dmat4 place = random_pose(random, 3), pose = sensor_near(place, random);
    const DrawList list = list_of(surfaces().grid, place * map.place);
    const std::vector<glm::dvec3> directions = directions_into(list, pose, 100, random);
    const std::vector<RayHit> found = host_engine().cast(list, pose, directions);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!(found[i].range_m < kInfinity)) continue;
      Vector corners[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector p = vertex(map.mesh.indices[std::size_t{3} * found[i].primitive + k]);
        corners[k] = glm::mat<3, 3, long double>(glm::dmat3(place)) * p + Vector(place[3]) - Vector(pose[3]);
      }
      const Vector normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
      const Vector way = glm::mat<3, 3, long double>(glm::dmat3(pose)) * Vector(directions[i]);
      const auto truth_m = static_cast<double>(glm::dot(normal, corners[0]) / glm::dot(normal, way));
      beyond += std::abs(found[i].range_m - truth_m) > found[i].error_bound_m;
      worst_rel = std::max(worst_rel, found[i].error_bound_m / truth_m);
      ++hits;
    }
  }
  CHECK(hits > 1500);
  CHECK(beyond == 0);
  MESSAGE(hits << " hits, largest relative bound " << worst_rel);
}

TEST_CASE("a grid has no tree over its triangles") {
  const RayEngine engine = each_engine();
  const DrawList list = list_of(surfaces().grid, glm::dmat4(1));
  CHECK(engine.cast_one(list, {0, 0, -1}, at(0.1, 0.2, 5)).range_m < kInfinity);
  CHECK(engine.caster->counters().meshes_built == 1);
  CHECK(engine.caster->counters().triangles_built == 0);
}

}  // namespace simvis
