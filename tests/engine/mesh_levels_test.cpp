// Coarser levels of meshes and their errors, against geometry.
#include "engine/geometry/mesh_levels.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include "engine/base/thread_pool.h"
#include "engine/geometry/mesh_tiles.h"
#include "engine/geometry/surface_deviation.h"
#include "engine/geometry/thinning.h"
#include "tests/engine/level_meshes.h"
#include "tests/support/random_room.h"
#include "tests/support/renderer_scene.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

// surface_deviation() may exceed the distance by this factor.
constexpr double kDeviationSlack = 1.2;

// Coordinates are float32: a few units in the last place of 1 m.
constexpr double kFloat_m = 1e-6;

double area_m2(const Mesh& mesh) {
  double area = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[i + k]]); };
    area += 0.5 * glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
  }
  return area;
}

// Squares of side 0.1 m, far apart, each from both sides, with two triangles a side.
Mesh loose_cards(int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const float x = 0.5f * static_cast<float>(i % 16), y = 0.5f * static_cast<float>(i / 16);
    for (const glm::vec2& at : {glm::vec2(0, 0), {0.1f, 0}, {0.1f, 0.1f}, {0, 0.1f}}) {
      mesh.positions.push_back({x + at.x, y + at.y, 0});
      mesh.attributes.push_back({.uv = {at * 10.0f, {0, 0}}});
    }
    for (const std::uint32_t k : {0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0}) mesh.indices.push_back(first + k);
  }
  compute_bounds(mesh);
  return mesh;
}

SurfaceTree surface(const Mesh& mesh) { return {mesh.positions, mesh.indices}; }

constexpr int kSamplesOfSide = 4;

// Points of the surface. Each of its points is in a small triangle of samples, so nearer to one of them than the
// longest side of a triangle divided by kSamplesOfSide.
std::vector<glm::dvec3> samples_of(const Mesh& mesh) {
  std::vector<glm::dvec3> samples;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const auto corner = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[t + k]]); };
    for (int i = 0; i <= kSamplesOfSide; ++i) {
      for (int k = 0; i + k <= kSamplesOfSide; ++k) {
        const double u = 1.0 * i / kSamplesOfSide, v = 1.0 * k / kSamplesOfSide;
        samples.push_back(corner(0) + u * (corner(1) - corner(0)) + v * (corner(2) - corner(0)));
      }
    }
  }
  return samples;
}

double longest_side_m(const Mesh& mesh) {
  double longest = 0;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      longest = std::max<double>(
          longest, glm::distance(mesh.positions[mesh.indices[t + k]], mesh.positions[mesh.indices[t + (k + 1) % 3]]));
    }
  }
  return longest;
}

// By another way than the code's: the plane if the point is above the triangle, else the sides.
double distance_m(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const std::array<glm::dvec3, 3> corner{a, b, c};
  const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
  bool above = true;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 &from = corner[i], &to = corner[(i + 1) % 3], along = to - from;
    above = above && glm::dot(glm::cross(along, p - from), normal) >= 0;
    const double share = std::clamp(glm::dot(p - from, along) / glm::dot(along, along), 0.0, 1.0);
    nearest = std::min(nearest, glm::distance(p, from + share * along));
  }
  return above ? std::abs(glm::dot(p - a, normal)) : nearest;
}

// The largest distance of samples of either surface from the other one, by comparing all with all.
double sampled_deviation_m(const Mesh& a, const Mesh& b) {
  double largest = 0;
  for (const auto& pair : {std::pair(&a, &b), std::pair(&b, &a)}) {
    const Mesh *const from = pair.first, *const to = pair.second;
    for (const glm::dvec3& p : samples_of(*from)) {
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t t = 0; t < to->indices.size() && nearest > largest; t += 3) {
        const auto corner = [&](std::size_t k) { return glm::dvec3(to->positions[to->indices[t + k]]); };
        nearest = std::min(nearest, distance_m(p, corner(0), corner(1), corner(2)));
      }
      largest = std::max(largest, nearest);
    }
  }
  return largest;
}

using Edge = std::array<std::array<float, 3>, 2>;

// The border of a surface: its edges, by the positions of their ends, and how many more triangles run along them in one
// direction than in the other.
std::map<Edge, int> border_of(const Mesh& mesh) {
  std::map<Edge, int> border;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3 &a = mesh.positions[mesh.indices[t + k]], &b = mesh.positions[mesh.indices[t + (k + 1) % 3]];
      const Edge edge{{{a.x, a.y, a.z}, {b.x, b.y, b.z}}};
      edge[0] < edge[1] ? ++border[edge] : --border[{edge[1], edge[0]}];
    }
  }
  std::erase_if(border, [](const auto& each) { return each.second == 0; });
  return border;
}

}  // namespace

TEST_CASE("the distance of two surfaces is bounded from both sides") {
  const Mesh square = test::rectangle(-1, -1, 1, 1);
  Mesh shifted = square;
  for (glm::vec3& p : shifted.positions) p.z += 0.25f;
  CHECK(surface_deviation(surface(square), surface(shifted), 1e-3) == doctest::Approx(0.25).epsilon(1e-6));

  // A part that only one of them has counts, whichever comes first.
  Mesh more = square;
  more.positions.insert(more.positions.end(), {{3, 0, 0}, {4, 0, 0}, {3, 0.5f, 0}});
  more.indices.insert(more.indices.end(), {4, 5, 6});
  for (const double deviation : {surface_deviation(surface(square), surface(more), 1e-3),
                                 surface_deviation(surface(more), surface(square), 1e-3)}) {
    CHECK(deviation >= 3);  // the corner at x = 4 from the side at x = 1
    CHECK(deviation <= 3 * kDeviationSlack);
  }

  // Balls around the same middle: at least the difference of the radii, at most that and the sagitta.
  const Mesh ball = sphere_mesh(1, 48), larger = sphere_mesh(1.1, 40);
  const double bound = surface_deviation(surface(ball), surface(larger), 1e-3);
  CHECK(bound >= 0.1 - kFloat_m);
  CHECK(bound <= (0.1 + test::sagitta_m(1, 48) + kFloat_m) * kDeviationSlack);
}

// Only the rectangle has points far from the other surface, and none of them is a corner or a middle of its triangles.
TEST_CASE("a hole in a grid is found wherever it is") {
  constexpr std::uint32_t kCells = 8;
  constexpr double kCell_m = 0.25;
  const SurfaceTree whole = surface(test::rectangle(0, 0, kCells * kCell_m, kCells * kCell_m));
  for (std::uint32_t hole = 0; hole < kCells * kCells; ++hole) {
    Mesh grid;
    for (std::uint32_t i = 0; i < (kCells + 1) * (kCells + 1); ++i) {
      grid.positions.push_back(glm::vec3(i % (kCells + 1), i / (kCells + 1), 0) * static_cast<float>(kCell_m));
    }
    for (std::uint32_t cell = 0; cell < kCells * kCells; ++cell) {
      const std::uint32_t at = cell / kCells * (kCells + 1) + cell % kCells, above = at + kCells + 1;
      if (cell != hole) grid.indices.insert(grid.indices.end(), {at, at + 1, above, at + 1, above + 1, above});
    }
    // The middle of a hole is half a cell from its border; at a corner of the grid, the corner is a whole one.
    const double bound_m = surface_deviation(whole, surface(grid), 1e-3);
    CAPTURE(hole);
    CHECK(bound_m >= kCell_m / 2);
    CHECK(bound_m <= kCell_m * kDeviationSlack);
  }
}

TEST_CASE("no sample of a level or of its mesh is farther from the other one than the level's error") {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    const Mesh mesh = test::hills(20, seed);
    const std::vector<MeshLevel> levels = make_levels(mesh, LevelBorders::free, {});
    REQUIRE(levels.size() >= 3);
    const SurfaceTree exact = surface(mesh);
    for (const MeshLevel& level : levels) {
      CAPTURE(level.mesh->indices.size());
      const double sampled_m = sampled_deviation_m(mesh, *level.mesh);
      CHECK(sampled_m <= level.error_m);
      const double bound_m = surface_deviation(exact, surface(*level.mesh), 1e-4);
      CHECK(sampled_m <= bound_m);
      // Distances differ by no more than points are apart.
      const double apart_m = std::max(longest_side_m(mesh), longest_side_m(*level.mesh)) / kSamplesOfSide;
      CHECK(bound_m <= (sampled_m + apart_m) * kDeviationSlack);
      // Each level adds its distance from the one before, and is about twice as far away as that.
      CHECK(level.error_m <= 3 * bound_m);
    }
  }
}

TEST_CASE("the bound and the levels do not depend on the number of threads") {
  const Mesh mesh = test::hills(40, 4);
  const std::shared_ptr<ThreadPool> pool = shared_thread_pool(3);
  const std::vector<MeshLevel> alone = make_levels(mesh, LevelBorders::free, {}),
                               together = make_levels(mesh, LevelBorders::free, {}, pool.get());
  REQUIRE(alone.size() == together.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    CHECK(alone[i].error_m == together[i].error_m);
    CHECK(*alone[i].mesh == *together[i].mesh);
  }
}

TEST_CASE("a large mesh has tiles whose levels all have the borders of the tile") {
  const auto mesh = std::make_shared<const Mesh>(test::hills(test::kTiledCells, 5));
  REQUIRE(mesh->indices.size() >= 3 * kMinTiledTriangles);
  const std::vector<LevelledTile> tiles = make_levelled_tiles(mesh, {});
  CHECK(tiles.size() == 16);  // halved four times
  std::size_t corners = 0, levels = 0;
  for (const LevelledTile& tile : tiles) {
    CHECK(tile.mesh->indices.size() <= 3 * kTileTriangles);
    corners += tile.mesh->indices.size();
    levels += tile.levels.size();
    const auto border = border_of(*tile.mesh);
    CHECK(border.size() > 100);
    for (const MeshLevel& level : tile.levels) CHECK(border_of(*level.mesh) == border);
  }
  CHECK(corners == mesh->indices.size());
  CHECK(levels >= 2 * tiles.size());

  // Triangles with vertices of their own are one surface if they are at the same places; loose cards are not.
  Mesh faceted;
  for (const std::uint32_t vertex : mesh->indices) {
    faceted.indices.push_back(static_cast<std::uint32_t>(faceted.positions.size()));
    faceted.positions.push_back(mesh->positions[vertex]);
  }
  faceted.attributes.resize(faceted.positions.size());
  compute_bounds(faceted);
  CHECK(make_levelled_tiles(std::make_shared<const Mesh>(std::move(faceted)), {}).size() == tiles.size());
  const auto cards = std::make_shared<const Mesh>(loose_cards(kMinTiledTriangles / 4));  // of four triangles each
  CHECK(make_levelled_tiles(cards, {}).size() == 1);

  const auto small = std::make_shared<const Mesh>(test::ball_mesh());
  const std::vector<LevelledTile> whole = make_levelled_tiles(small, {});
  REQUIRE(whole.size() == 1);
  CHECK(whole[0].mesh == small);
  CHECK(whole[0].levels.size() == make_levels(*small, LevelBorders::free, {}).size());
}

TEST_CASE("levels of a ball halve its triangles, and their errors are bounds") {
  const Mesh ball = test::ball_mesh();
  const std::vector<MeshLevel> levels = make_levels(ball, LevelBorders::free, {});
  REQUIRE(levels.size() >= 4);
  std::size_t triangles = ball.indices.size() / 3;
  double error_m = 0;
  for (const MeshLevel& level : levels) {
    const std::size_t fewer = level.mesh->indices.size() / 3;
    CHECK(fewer < 0.6 * static_cast<double>(triangles));
    triangles = fewer;
    CHECK(level.error_m > error_m);
    error_m = level.error_m;
    // The corners lie on the ball, so the middle of a triangle shows how far the surface has moved inwards; the exact
    // mesh has moved by its own sagitta.
    double deepest_m = 0;
    for (std::size_t i = 0; i < level.mesh->indices.size(); i += 3) {
      glm::dvec3 middle(0);
      for (std::size_t k = 0; k < 3; ++k) {
        const glm::dvec3 corner(level.mesh->positions[level.mesh->indices[i + k]]);
        CHECK(glm::length(corner) == doctest::Approx(test::kBallRadius_m).epsilon(kFloat_m));
        middle += corner / 3.0;
      }
      deepest_m = std::max(deepest_m, test::kBallRadius_m - glm::length(middle));
    }
    CHECK(level.error_m >= deepest_m - test::sagitta_m(test::kBallRadius_m, test::kBallSegments) - kFloat_m);
    CHECK(level.error_m <= 3 * deepest_m + 0.01 * test::kBallRadius_m);  // and no gross exaggeration
  }
  CHECK(make_levels(test::rectangle(0, 0, 1, 1), LevelBorders::free, {}).empty());
  Mesh moving = ball;
  moving.short_lived = true;
  CHECK(make_levels(moving, LevelBorders::free, {}).empty());
}

TEST_CASE("levels of loose cards have half the cards, the same area, and both sides") {
  const Mesh cards = loose_cards(256);
  const std::vector<MeshLevel> levels = make_levels(cards, LevelBorders::free, {});
  REQUIRE(levels.size() >= 1);
  double share = 1;
  for (const MeshLevel& level : levels) {
    share /= 2;
    CHECK(static_cast<double>(level.mesh->indices.size()) == share * static_cast<double>(cards.indices.size()));
    CHECK(area_m2(*level.mesh) == doctest::Approx(area_m2(cards)).epsilon(1e-5));  // float32 coordinates up to 8 m
    std::multiset<std::set<std::uint32_t>> triangles;
    for (std::size_t i = 0; i < level.mesh->indices.size(); i += 3) {
      const auto* const corner = &level.mesh->indices[i];
      triangles.insert({corner[0], corner[1], corner[2]});
    }
    for (const auto& triangle : triangles) CHECK(triangles.count(triangle) == 2);
    // A card that is left out is half a metre from the next one, or less; a card grows by at most its size.
    CHECK(level.error_m >= 0.3);
  }
}

TEST_CASE("levels are kept on disk, and a damaged file is made again") {
  const TemporaryFolder folder;
  const Mesh ball = test::ball_mesh();
  const std::vector<MeshLevel> made = make_levels(ball, LevelBorders::free, folder.path());
  const auto same = [&](const std::vector<MeshLevel>& levels) {
    return std::ranges::equal(levels, made, [](const MeshLevel& a, const MeshLevel& b) {
      return *a.mesh == *b.mesh && a.error_m == b.error_m;
    });
  };
  std::vector<std::filesystem::path> files;
  for (const auto& file : std::filesystem::directory_iterator(folder.path())) files.push_back(file.path());
  REQUIRE(files.size() == 1);
  CHECK(files[0].filename().string().starts_with("levels-"));
  CHECK(same(make_levels(ball, LevelBorders::free, folder.path())));
  const auto size = std::filesystem::file_size(files[0]);
  for (const std::uintmax_t at : {std::uintmax_t{3}, std::uintmax_t{50}, size / 2, size - 2}) {
    std::fstream file(files[0], std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(at));
    file.put('\x5a');
    file.close();
    CHECK(same(make_levels(ball, LevelBorders::free, folder.path())));
  }
}

TEST_SUITE_END();
