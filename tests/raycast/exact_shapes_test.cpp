// Rays against round shapes and endless planes, compared with closed forms in quadruple precision. By hand:
// SIMVIS_TEST_SHAPE_RAYS=1000000 rays for each shape.
#include "tests/support/exact_shapes.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <simvis/surface_point.h>
#include "scenegraph/primitive_meshes.h"
#include "tests/support/infinity.h"
#include "tests/support/long_count.h"
#include "tests/support/ray_casting.h"

TEST_SUITE_BEGIN("engine/raycast");

using namespace simvis;

namespace {

// Half a unit in the last place of float32, in which ranges are stored, and what is left of double at grazing
// incidence.
constexpr double kMaxError_rel = 6e-8;

// A ray that passes an outline closer than this share of all lengths may hit or miss: 28 u of ray_caster.h and 57 u of
// ray_surface.h on what is left after a shear, with a factor of 10.
constexpr double kDoubt_rel = 1000 * 0x1p-53;

struct Placed {
  std::string name;
  Mesh mesh;
  glm::dmat4 world_from_mesh;
  double reach_m = 1;  // of the shape in the world
};

struct Outcome {
  std::size_t rays = 0, hits = 0, inside = 0, doubtful = 0;
  std::size_t wrong = 0, beyond_bound = 0;
  double worst_rel = 0;
  std::vector<double> bounds_rel;
};

glm::dmat4 sheared() {
  glm::dmat4 matrix(1);
  matrix[1][0] = 0.7;
  matrix[2][1] = -0.4;
  return matrix;
}

// The shape in poses, scales and mirrors; the reach is that of a shape of about one metre.
std::vector<Placed> placed_shapes(const std::string& name, const Mesh& mesh, std::mt19937& random) {
  const glm::dvec3 scales[] = {{1, 1, 1}, {-1, 1, 1}, {0.5, 2, 3}, {1e-3, -1, 1}, {1, 1, 1e-3}, {-20, -20, -20}};
  std::vector<Placed> all;
  for (const glm::dvec3& scale : scales) {
    const double reach_m = 3 * std::max({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z)});
    all.push_back({name, mesh, glm::scale(random_pose(random, 5), scale), reach_m});
  }
  all.push_back({name + ", sheared", mesh, random_pose(random, 5) * sheared(), 5});
  all.push_back({name + ", 10^6 m away", mesh, at(1e6, -7e5, 3e5) * random_pose(random, 5), 3});
  return all;
}

// A third of the sensors stand far away, a third close by, a third within reach of the shape's middle, and so inside.
glm::dmat4 sensor_at(const Placed& placed, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double distances_m[] = {0.2 * unit(random), 0.5 + 2 * unit(random), std::pow(10, 1 + 2 * unit(random))};
  const double distance_m = placed.reach_m * distances_m[random() % 3];
  const glm::dvec3 middle(placed.world_from_mesh[3]);
  glm::dmat4 pose = random_pose(random, 0);
  pose[3] = glm::dvec4(middle + distance_m * random_direction(random), 1);
  return pose;
}

// Half of the directions are random towards the box, half pass the outline at a distance of 0.1 to 10^-9 of the size.
glm::dvec3 direction_to(const Placed& placed, const glm::dmat4& pose, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const Mesh& mesh = placed.mesh;
  glm::dvec3 point;
  if (random() % 2 == 0) {
    const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max), middle = 0.5 * (low + high);
    point = middle + 0.6 * (high - low) * glm::dvec3(unit(random), unit(random), unit(random));
  } else {
    const auto index = mesh.indices[random() % mesh.indices.size()];
    point =
        glm::dvec3(mesh.positions[index]) * (1 + std::pow(10, -5 + 4 * unit(random)) * (random() % 2 == 0 ? 1 : -1));
  }
  const glm::dvec3 way(rigid_inverse(pose) * (placed.world_from_mesh * glm::dvec4(point, 1)));
  return glm::length(way) > 0 ? glm::normalize(way) : glm::dvec3(1, 0, 0);
}

// Whether a shape that is a little larger or smaller is hit elsewhere: at another face, or not at all.
bool is_doubtful(const Placed& placed, const glm::dmat4& pose, const glm::dvec3& direction, double lengths_m) {
  // No direction is shrunk to less than 1 / |inverse|.
  const glm::dmat3 inverse = glm::inverse(glm::dmat3(placed.world_from_mesh));
  const double by_m =
      kDoubt_rel * lengths_m *
      std::sqrt(glm::dot(inverse[0], inverse[0]) + glm::dot(inverse[1], inverse[1]) + glm::dot(inverse[2], inverse[2]));
  reference::ShapeHit hits[2];
  for (int i = 0; i < 2; ++i) {
    const auto shape = reference::grown(*placed.mesh.surface, i == 0 ? by_m : -by_m);
    if (!shape) return true;
    hits[i] = reference::nearest_hit(*shape, placed.world_from_mesh, pose, direction);
  }
  const bool first = hits[0].range_m < kInfinity, second = hits[1].range_m < kInfinity;
  if (first != second) return true;
  return first && std::abs(static_cast<double>(hits[0].range_m - hits[1].range_m)) > 1e-3 * lengths_m;
}

void hold(const Placed& placed, const glm::dmat4& pose, const glm::dvec3& direction, const RayHit& hit,
          Outcome& outcome) {
  const reference::ShapeHit exact =
      reference::nearest_hit(*placed.mesh.surface, placed.world_from_mesh, pose, direction);
  const auto truth_m = static_cast<double>(exact.range_m);
  const glm::dvec3 middle(placed.world_from_mesh[3]), sensor(pose[3]);
  const double lengths_m = placed.reach_m + glm::distance(middle, sensor) + glm::length(middle) + glm::length(sensor);
  ++outcome.rays;
  const bool same_kind = (truth_m < kInfinity) == (hit.range_m < kInfinity);
  const double error_m = same_kind && truth_m < kInfinity
                             ? std::abs(static_cast<double>(reference::Quad(hit.range_m) - exact.range_m))
                             : 0;
  if (!same_kind || error_m > hit.error_bound_m) {
    if (is_doubtful(placed, pose, direction, lengths_m)) {
      ++outcome.doubtful;
    } else {
      ++(same_kind ? outcome.beyond_bound : outcome.wrong);
    }
    return;
  }
  if (truth_m == kInfinity) return;
  ++outcome.hits;
  outcome.bounds_rel.push_back(hit.error_bound_m / truth_m);
  const double stored_m = static_cast<float>(hit.range_m);
  outcome.worst_rel = std::max(outcome.worst_rel, std::abs(stored_m - truth_m) / truth_m);
}

void check(const RayEngine& engine, const std::string& name, const Mesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  const std::vector<Placed> all = placed_shapes(name, mesh, random);
  const auto rays = static_cast<std::size_t>(count_of("SIMVIS_TEST_SHAPE_RAYS", 4000)) / all.size();
  Outcome sum;
  for (const Placed& placed : all) {
    DrawList list;
    add_item(list, placed.mesh, placed.world_from_mesh);
    constexpr std::size_t kFromOnePose = 50;
    for (std::size_t done = 0; done < rays; done += kFromOnePose) {
      const glm::dmat4 pose = sensor_at(placed, random);
      std::vector<glm::dvec3> directions;
      for (std::size_t i = 0; i < kFromOnePose; ++i) directions.push_back(direction_to(placed, pose, random));
      const std::vector<RayHit> hits = engine.cast(list, pose, directions);
      for (std::size_t i = 0; i < kFromOnePose; ++i) hold(placed, pose, directions[i], hits[i], sum);
    }
  }
  REQUIRE(!sum.bounds_rel.empty());
  std::ranges::nth_element(sum.bounds_rel, sum.bounds_rel.begin() + std::ptrdiff_t(sum.bounds_rel.size() / 2));
  MESSAGE(name << ": " << sum.rays << " rays, " << sum.hits << " hits, " << sum.doubtful << " at an outline; wrong "
               << sum.wrong << ", beyond the bound " << sum.beyond_bound << "; largest relative error as float32 "
               << sum.worst_rel << ", median bound / range " << sum.bounds_rel[sum.bounds_rel.size() / 2]);
  CHECK(sum.wrong == 0);
  CHECK(sum.beyond_bound == 0);
  CHECK(sum.worst_rel <= kMaxError_rel);
  CHECK(sum.hits > sum.rays / 4);
  CHECK(sum.doubtful < sum.rays / 1000 + 1);
}

}  // namespace

TEST_CASE("random rays meet round shapes where closed forms say, within their bounds") {
  const RayEngine engine = each_engine();
  check(engine, "sphere", sphere_mesh(1), 1);
  check(engine, "sphere of an odd radius", sphere_mesh(0.1234567), 2);
  check(engine, "cylinder", cylinder_mesh(0.4, 1.7), 3);
  check(engine, "long cylinder", cylinder_mesh(0.01, 2), 4);
  check(engine, "disc", cylinder_mesh(1, 0.001), 5);
  check(engine, "cone", cone_mesh(0.7, 1.1), 6);
  check(engine, "needle", cone_mesh(0.01, 2), 7);
  check(engine, "flat cone", cone_mesh(1, 0.01), 8);
  check(engine, "capsule", capsule_mesh(0.3, 1.2), 9);
  check(engine, "long capsule", capsule_mesh(0.01, 2), 10);
  check(engine, "plane", endless_plane_mesh({kInfinity, kInfinity}), 11);
  check(engine, "strip", endless_plane_mesh({0.8, kInfinity}), 12);
}
