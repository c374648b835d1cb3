// Rays into clouds of spheres: each sphere by itself in quadruple precision, and the same spheres as items of their
// own. By hand: SIMVIS_TEST_CLOUD_RAYS=1000000.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <simvis/surface_point.h>
#include "scenegraph/primitive_meshes.h"
#include "tests/support/exact_shapes.h"
#include "tests/support/infinity.h"
#include "tests/support/long_count.h"
#include "tests/support/ray_casting.h"

TEST_SUITE_BEGIN("engine/raycast");

namespace simvis {
namespace {

// Half a unit in the last place of float32, in which ranges are stored.
constexpr double kCloudError_rel = 6e-8;

// A ray that passes an outline closer than this share of all lengths may hit or miss, as in exact_shapes_test.cpp.
constexpr double kCloudDoubt_rel = 1000 * 0x1p-53;

Mesh cloud_of(std::size_t points, double radius_m, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1, 1);
  Mesh mesh;
  mesh.name = "cloud";
  mesh.topology = Topology::points;
  mesh.surface = ExactSurface{.kind = SurfaceKind::sphere, .radius_m = radius_m};
  for (std::uint32_t i = 0; i < points; ++i) {
    mesh.positions.emplace_back(2 * unit(random), unit(random), unit(random));
    mesh.attributes.push_back({.color = {0.25f * static_cast<float>(i % 4), 0.5f, 1, 1}});
    mesh.indices.push_back(i);
  }
  compute_bounds(mesh);
  return mesh;
}

DrawList list_with(const Mesh& mesh, const glm::dmat4& place) {
  DrawList list;
  add_item(list, mesh, place);
  return list;
}

// Towards points, past their outlines, and anywhere.
std::vector<glm::dvec3> directions_at(const Mesh& cloud, const glm::dmat4& place, const glm::dmat4& pose,
                                      std::size_t count, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> directions;
  while (directions.size() < count) {
    const glm::dvec3 point(cloud.positions[random() % cloud.positions.size()]);
    const glm::dvec3 aim = point + cloud.surface->radius_m * (random() % 3 == 0 ? 1.0 : 0.5) *
                                       (random() % 2 == 0 ? random_direction(random) : glm::dvec3(normal(random)));
    const glm::dvec3 way(rigid_inverse(pose) * (place * glm::dvec4(aim, 1)));
    directions.push_back(glm::length(way) > 0 ? glm::normalize(way) : random_direction(random));
  }
  return directions;
}

struct CloudTruth {
  reference::Quad range_m = kInfinity;
  std::uint32_t point = 0;
};

// The nearest hit among all spheres that are larger by `by_m`.
CloudTruth truth_of(const Mesh& cloud, const glm::dmat4& place, const glm::dmat4& pose, const glm::dvec3& direction,
                    double by_m) {
  CloudTruth nearest;
  const reference::MeshRay in_mesh = reference::ray_in_mesh(place, pose, direction);
  ExactSurface sphere = *cloud.surface;
  sphere.radius_m += by_m;
  for (std::uint32_t i = 0; i < cloud.indices.size(); ++i) {
    reference::MeshRay ray = in_mesh;
    for (int axis = 0; axis < 3; ++axis) ray.from[axis] -= reference::Quad(cloud.positions[i][axis]);
    const reference::ShapeHit hit = reference::ShapeRay(sphere, ray).nearest();
    if (hit.range_m < nearest.range_m) nearest = {hit.range_m, i};
  }
  return nearest;
}

}  // namespace

TEST_CASE("random rays meet the spheres of a cloud where closed forms say, within their bounds") {
  const RayEngine engine = each_engine();
  std::mt19937 random(31);
  const auto rays = static_cast<std::size_t>(count_of("SIMVIS_TEST_CLOUD_RAYS", 3000));
  std::size_t cast = 0, hits = 0, wrong = 0, beyond = 0, doubtful = 0;
  double worst_rel = 0;
  while (cast < rays) {
    const Mesh cloud = cloud_of(60, 0.02 + 0.1 * (random() % 3), random);
    for (const glm::dvec3& scale : {glm::dvec3(1), glm::dvec3(-1, 1, 1), glm::dvec3(0.5, 2, 3), glm::dvec3(10)}) {
      const glm::dmat4 place = glm::scale(random_pose(random, 3), scale);
      glm::dmat4 pose = random_pose(random, 0);
      pose[3] = place * glm::dvec4((random() % 2 == 0 ? 5.0 : 0.5) * random_direction(random), 1);
      const DrawList list = list_with(cloud, place);
      const std::vector<glm::dvec3> directions = directions_at(cloud, place, pose, 50, random);
      const std::vector<RayHit> found = engine.cast(list, pose, directions);
      for (std::size_t i = 0; i < found.size(); ++i) {
        constexpr double kLengths_m = 100;  // none here is longer
        const double by_m = kCloudDoubt_rel * kLengths_m;
        const CloudTruth exact = truth_of(cloud, place, pose, directions[i], 0);
        const bool is_hit = found[i].range_m < kInfinity;
        const double error_m = is_hit && exact.range_m < kInfinity
                                   ? std::abs(static_cast<double>(reference::Quad(found[i].range_m) - exact.range_m))
                                   : 0;
        const bool same = is_hit == (exact.range_m < kInfinity) && (!is_hit || found[i].primitive == exact.point);
        ++cast;
        hits += is_hit;
        if (same && error_m <= found[i].error_bound_m) {
          if (is_hit) {
            const auto truth_m = static_cast<double>(exact.range_m);
            worst_rel = std::max(
                worst_rel, std::abs(static_cast<double>(static_cast<float>(found[i].range_m)) - truth_m) / truth_m);
          }
          continue;
        }
        const CloudTruth larger = truth_of(cloud, place, pose, directions[i], by_m),
                         smaller = truth_of(cloud, place, pose, directions[i], -by_m);
        const bool at_outline =
            larger.point != smaller.point || (larger.range_m < kInfinity) != (smaller.range_m < kInfinity);
        ++(at_outline ? doubtful : same ? beyond : wrong);
      }
    }
  }
  MESSAGE(cast << " rays, " << hits << " hits, " << doubtful << " at an outline; largest relative error as float32 "
               << worst_rel);
  CHECK(wrong == 0);
  CHECK(beyond == 0);
  CHECK(worst_rel <= kCloudError_rel);
  CHECK(hits > cast / 3);
  CHECK(doubtful <= cast / 1000 + 1);
}

// The ways through the tree, in packets and one by one, from one place and many, and the device, find the same points.
TEST_CASE("a cloud has the hits of its spheres as items of their own, by every way of casting") {
  std::mt19937 random(32);
  for (const std::size_t points : {1u, 700u, 5000u}) {
    CAPTURE(points);
    const Mesh cloud = cloud_of(points, 0.03, random);
    const DrawList list = list_with(cloud, glm::dmat4(1));
    DrawList single;
    for (const glm::vec3& point : cloud.positions) {
      add_item(single, sphere_mesh(0.03), glm::translate(glm::dmat4(1), glm::dvec3(point)));
    }
    const glm::dmat4 pose = at(-4, 0.3, 0.2);
    const std::vector<glm::dvec3> directions = directions_at(cloud, glm::dmat4(1), pose, 2000, random);
    const std::vector<RayHit> hits = host_engine().cast(list, pose, directions);
    CHECK(device_engine().cast(list, pose, directions) == hits);
    std::vector<RayHit> from_many(hits.size());
    const RayEngine many = host_engine();
    many.caster->set_world(list);
    many.caster->cast_from(pose, std::vector<glm::dvec3>(hits.size(), glm::dvec3(0)), directions, from_many);
    CHECK(from_many == hits);
    const std::vector<RayHit> expected = host_engine().cast(single, pose, directions);
    std::size_t other = 0, found = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
      // The middle of a sphere is subtracted in another order.
      constexpr double kOrder_rel = 1e-12;
      const bool same = hits[i].range_m == expected[i].range_m ||
                        (hits[i].primitive == expected[i].item &&
                         std::abs(hits[i].range_m - expected[i].range_m) <=
                             kOrder_rel * hits[i].range_m + expected[i].error_bound_m + hits[i].error_bound_m);
      other += !same;
      found += hits[i].range_m < kInfinity;
    }
    CHECK(other == 0);
    CHECK(found > hits.size() / 4);
  }
}

TEST_CASE("normals of points are those of their spheres, and colours are theirs") {
  std::mt19937 random(33);
  const Mesh cloud = cloud_of(200, 0.1, random);
  const glm::dmat4 place = at(1, 2, 3), pose = at(-3, 2, 3);
  const DrawList list = list_with(cloud, place);
  std::size_t hits = 0;
  for (const glm::dvec3& direction : directions_at(cloud, place, pose, 200, random)) {
    const RayHit hit = host_engine().cast_one(list, direction, pose);
    if (hit.range_m == kInfinity) continue;
    const SurfacePoint point = surface_point(list, pose, direction, hit);
    const glm::dvec3 met = glm::dvec3(pose[3]) + hit.range_m * direction - glm::dvec3(place[3]);
    const glm::dvec3 normal = glm::normalize(met - glm::dvec3(cloud.positions[hit.primitive]));
    constexpr double kOwn_rad = 1e-13;  // of the expected normal, of lengths of 5 m over 0.1 m
    CHECK(glm::length(glm::cross(point.normal, normal)) <= point.normal_error_rad + kOwn_rad);
    CHECK(point.normal_error_rad < 1e-9);
    CHECK(glm::dot(point.normal, direction) < 0);
    CHECK(point.base_color == cloud.attributes[hit.primitive].color);
    CHECK(point.primitive == hit.primitive);
    ++hits;
  }
  CHECK(hits > 100);
}

TEST_CASE("clouds without a radius, and those that a transform flattens, are met by no ray") {
  const RayEngine engine = each_engine();
  std::mt19937 random(34);
  Mesh cloud = cloud_of(2000, 0.2, random);
  CHECK(engine.cast_one(list_with(cloud, glm::dmat4(1)), {1, 0, 0}, at(-4, 0, 0)).range_m < kInfinity);
  CHECK(engine.cast_one(list_with(cloud, glm::scale(glm::dmat4(1), {1, 1, 0})), {1, 0, 0}, at(-4, 0, 0)).range_m ==
        kInfinity);
  cloud.surface.reset();
  CHECK(engine.cast_one(list_with(cloud, glm::dmat4(1)), {1, 0, 0}, at(-4, 0, 0)).range_m == kInfinity);
}

TEST_CASE("the bounds of a cloud contain its spheres") {
  std::mt19937 random(35);
  const Mesh cloud = cloud_of(50, 0.123456789, random);
  for (const glm::vec3& point : cloud.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(static_cast<double>(cloud.bounds_min[axis]) <= static_cast<double>(point[axis]) - 0.123456789);
      CHECK(static_cast<double>(cloud.bounds_max[axis]) >= static_cast<double>(point[axis]) + 0.123456789);
    }
  }
}

}  // namespace simvis
