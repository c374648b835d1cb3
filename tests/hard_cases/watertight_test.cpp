// No beam escapes from closed meshes: not between triangles, not along their edges, not at their corners.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/hard_cases/hard_case.h"
#include "tests/support/infinity.h"
#include "tests/support/ray_casting.h"
#include "tests/support/reference_directions.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("hard_cases");

using namespace simvis;

namespace {

// Each beam is about thirty times slower under sanitizers.
const std::size_t kFewerBeams = sanitized() ? 100 : 1, kBeamsOfAPlace = sanitized() ? 5'000 : 50'000;

const std::size_t kAllBeams = 10'000'000 / kFewerBeams;

/// A box of half the size `half_m` whose sides are cut into `cells` x `cells` squares, each of two triangles. Vertices
/// within a side are moved along it at random, by up to a quarter of a cell; `jitter` 0 leaves the grid as it is.
Mesh tessellated_box(const glm::dvec3& half_m, int cells, double jitter, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> vertices;
  const auto vertex = [&](const std::array<int, 3>& place) {
    const auto [known, added] = vertices.emplace(place, static_cast<std::uint32_t>(mesh.positions.size()));
    if (!added) return known->second;
    int sides = 0;
    for (const int i : place) sides += i == 0 || i == cells;
    glm::dvec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      const bool fixed = sides > 1 || place[axis] == 0 || place[axis] == cells;
      const double moved = place[axis] + (fixed ? 0 : 0.25 * jitter * unit(random));
      p[axis] = half_m[axis] * (2 * moved / cells - 1);
    }
    mesh.positions.emplace_back(p);
    return known->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (const int end : {0, cells}) {
      for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
          std::uint32_t corner[4];
          for (int k = 0; k < 4; ++k) {
            std::array<int, 3> place;
            place[axis] = end;
            place[(axis + 1) % 3] = i + (k & 1);
            place[(axis + 2) % 3] = j + (k >> 1);
            corner[k] = vertex(place);
          }
          mesh.indices.insert(mesh.indices.end(), {corner[0], corner[1], corner[3], corner[0], corner[3], corner[2]});
        }
      }
    }
  }
  return mesh;
}

/// A closed mesh that differs in all directions: a sphere whose vertices are moved in and out by up to `share`.
Mesh rough_sphere(double radius_m, double share, int segments, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Mesh mesh = closed_sphere_mesh(radius_m, segments);
  std::map<std::array<float, 3>, double> moved;  // equal vertices get equal displacements
  for (glm::vec3& p : mesh.positions) {
    const auto [known, added] = moved.emplace(std::array{p.x, p.y, p.z}, 1 + share * unit(random));
    p = glm::vec3(known->second * glm::dvec3(p));
  }
  return mesh;
}

/// Directions from a place within a mesh, in the mesh's frame: to every vertex, then for each triangle to points of its
/// edges, to their midpoints and into it.
std::vector<glm::dvec3> beams_at(const Mesh& mesh, const glm::dvec3& from, std::size_t count, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<glm::dvec3> directions;
  const auto aim = [&](const glm::dvec3& point) { directions.push_back(glm::normalize(point - from)); };
  for (const glm::vec3& vertex : mesh.positions) aim(vertex);
  const std::size_t triangles = mesh.indices.size() / 3;
  for (std::size_t triangle = random() % triangles; directions.size() < count; triangle = (triangle + 1) % triangles) {
    std::array<glm::dvec3, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = mesh.positions[mesh.indices[3 * triangle + k]];
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 edge = corner[(k + 1) % 3] - corner[k];
      for (int i = 0; i < 4; ++i) aim(corner[k] + unit(random) * edge);
      aim(corner[k] + 0.5 * edge);
    }
    const double u = unit(random), v = unit(random) * (1 - u);
    aim(corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]));
  }
  directions.resize(count);
  return directions;
}

/// Start points of beams, within half a metre of the mesh's centre.
enum class Place { anywhere, middle, on_plane_of_edge, on_grid };

glm::dvec3 place_in(const Mesh& mesh, Place place, double cell_m, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto a = glm::normalize(glm::dvec3(mesh.positions[mesh.indices[3 * (random() % (mesh.indices.size() / 3))]]));
  const auto b = glm::normalize(glm::dvec3(mesh.positions[mesh.indices[1]]));
  switch (place) {
    case Place::anywhere:
      return 0.5 * glm::dvec3(unit(random), unit(random), unit(random));
    case Place::middle:
      return glm::dvec3(0);
    case Place::on_plane_of_edge:  // the plane through the middle and an edge, or a diagonal
      return 0.25 * unit(random) * a + 0.25 * unit(random) * b;
    case Place::on_grid:
      return cell_m * glm::dvec3(random() % 2, random() % 2, random() % 2);
  }
  return {};
}

/// Range to the first of these planes along a ray from inside, which is the range to the surface of a convex mesh.
double range_within(const std::vector<glm::dvec4>& planes, const glm::dvec3& from, const glm::dvec3& direction) {
  double nearest = kInfinity;
  for (const glm::dvec4& plane : planes) {
    const double towards = glm::dot(glm::dvec3(plane), direction);
    if (towards > 0) nearest = std::min(nearest, (plane.w - glm::dot(glm::dvec3(plane), from)) / towards);
  }
  return nearest;
}

std::vector<glm::dvec4> box_planes(const glm::dvec3& half_m) {
  return {{1, 0, 0, half_m.x},  {0, 1, 0, half_m.y},  {0, 0, 1, half_m.z},
          {-1, 0, 0, half_m.x}, {0, -1, 0, half_m.y}, {0, 0, -1, half_m.z}};
}

/// Normal and distance of the plane of each triangle of a convex mesh about the origin.
std::vector<glm::dvec4> triangle_planes(const Mesh& mesh) {
  std::vector<glm::dvec4> planes;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
        c(mesh.positions[mesh.indices[i + 2]]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    if (glm::length(normal) == 0) continue;  // at a pole
    const glm::dvec3 outward = glm::normalize(glm::dot(normal, a) > 0 ? normal : -normal);
    planes.emplace_back(outward, glm::dot(outward, a));
  }
  return planes;
}

struct Solid {
  std::string name;
  Mesh mesh;
  double cell_m = 0;                    ///< of a grid that tessellation lines follow
  std::vector<glm::dvec4> planes = {};  ///< of a box
};

}  // namespace

TEST_CASE("none of 10,000,000 beams inside closed meshes escapes") {
  std::mt19937 random(1);
  const Solid solids[] = {
      {"box", half_box_mesh({5, 4, 3}), 1, box_planes({5, 4, 3})},
      {"sphere of 256 triangles", closed_sphere_mesh(3, 16), 1},
      {"sphere of 65,536 triangles", closed_sphere_mesh(3, 256), 1},
      {"room cut into a grid", tessellated_box({8, 8, 8}, 64, 0, random), 0.25, box_planes({8, 8, 8})},
      {"room cut irregularly", tessellated_box({6, 4, 2}, 32, 1, random), 0.125, box_planes({6, 4, 2})},
      {"rough sphere", rough_sphere(3, 0.3, 64, random), 1}};
  std::size_t beams = 0, escaped = 0, beyond_bound = 0;
  for (const Solid& solid : solids) {
    CAPTURE(solid.name);
    DrawList list;
    add_item(list, solid.mesh, glm::dmat4(1.0));
    const std::unique_ptr<RayCaster> caster = make_ray_caster(ray_device());
    std::vector<RayHit> hits;
    const std::size_t places = (kAllBeams / std::size(solids) + kBeamsOfAPlace - 1) / kBeamsOfAPlace;
    for (std::size_t place = 0; place < places; ++place) {
      list.world_from_node[1] = place / 4 % 2 == 0 ? glm::dmat4(1.0) : random_pose(random, 3);
      const glm::dvec3 from = place_in(solid.mesh, static_cast<Place>(place % 4), solid.cell_m, random);
      const std::vector<glm::dvec3> directions = beams_at(solid.mesh, from, kBeamsOfAPlace, random);
      hits.resize(directions.size());
      caster->set_world(list);
      caster->cast(list.world_from_node[1] * at(from.x, from.y, from.z), directions, hits);
      for (std::size_t i = 0; i < hits.size(); ++i) {
        escaped += std::isinf(hits[i].range_m);
        if (solid.planes.empty()) continue;
        const double error = std::abs(hits[i].range_m - range_within(solid.planes, from, directions[i]));
        beyond_bound += !(error <= hits[i].error_bound_m);
      }
      beams += directions.size();
    }
    CHECK(escaped == 0);
    CHECK(beyond_bound == 0);
  }
  CHECK(beams >= kAllBeams);
  add_line(std::to_string(beams) + " beams cast inside closed meshes", std::to_string(escaped) + " escape");
}

// Every method over the full sphere. The mesh is convex: its surface is the first of its triangles' planes.
TEST_CASE("no beam inside a closed mesh reads inf") {
  std::mt19937 random(2);
  // A vertex is rounded to float32 by up to sqrt(3) / 2 units of 2^-23 of its distance. This tilts two triangles of a
  // flat side against each other, and the plane of each deviates up to three times as much over the other.
  constexpr double kFlatSide_rel = 3 * 0.866 * 0x1p-23 / 0.9;  // 0.9: the smallest cosine of incidence
  struct Room {
    std::string name;
    Mesh mesh;
    glm::dvec3 from;
    double truth_error_rel = 0;
  };
  const Room rooms[] = {
      {"in the middle of a box", half_box_mesh({5, 4, 3}), {0, 0, 0}},
      {"in a box, elsewhere", half_box_mesh({5, 4, 3}), {1.1, -0.7, 0.4}},
      {"in a room cut into a grid, on the planes of its lines",
       tessellated_box({4, 4, 4}, 16, 0, random),
       {0.5, 1, -0.5}},
      {"in a room cut irregularly", tessellated_box({6, 4, 2}, 16, 1, random), {0.3, 0.2, 0.1}},
      {"in the middle of a sphere of 256 triangles", closed_sphere_mesh(3, 16), {0, 0, 0}, kFlatSide_rel},
      {"in a sphere of 256 triangles, elsewhere", closed_sphere_mesh(3, 16), {0.3, 0.2, -0.4}, kFlatSide_rel}};
  for (const Room& room : rooms) {
    HardCase hard{.name = room.name};
    add_item(hard.world, room.mesh, glm::dmat4(1.0));
    hard.world_from_sensor = at(room.from.x, room.from.y, room.from.z);
    hard.scanner.pattern = {.beams = kFewerBeams > 1 ? 65u : 181u,
                            .rings = kFewerBeams > 1 ? 17u : 33u,
                            .min_azimuth_rad = -kPi,
                            .max_azimuth_rad = kPi,
                            .min_elevation_rad = -kPi / 2,
                            .max_elevation_rad = kPi / 2};
    hard.truth = [planes = triangle_planes(room.mesh), from = room.from](const glm::dvec3& direction) {
      return range_within(planes, from, direction);
    };
    hard.truth_error_rel = room.truth_error_rel;
    const HardResults results = measure(hard);
    CHECK(results.nearest.wrong_kind == 0);
    CHECK(results.planar.wrong_kind == 0);
  }
}

TEST_SUITE_END();
