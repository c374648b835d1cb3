// Rays into clouds of spheres and discs: each one by itself in quadruple precision, and the same spheres as items of
// their own. By hand: SIMVIS_TEST_CLOUD_RAYS=1000000.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include <simvis/surface_point.h>
#include "engine/draw/solid_cloud.h"
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

Mesh cloud_of(std::size_t points, double radius_m, std::mt19937& random, SurfaceKind kind = SurfaceKind::sphere) {
  std::uniform_real_distribution<float> unit(-1, 1);
  Mesh mesh;
  mesh.name = "cloud";
  mesh.topology = Topology::points;
  mesh.surface = ExactSurface{.kind = kind, .radius_m = radius_m};
  for (std::uint32_t i = 0; i < points; ++i) {
    mesh.positions.emplace_back(2 * unit(random), unit(random), unit(random));
    mesh.attributes.push_back({.color = {0.25f * static_cast<float>(i % 4), 0.5f, 1, 1}});
    if (kind == SurfaceKind::disc) mesh.attributes.back().normal = glm::vec3(random_direction(random));
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

// The nearest hit among all spheres or discs that are larger by `by_m`.
CloudTruth truth_of(const Mesh& cloud, const glm::dmat4& place, const glm::dmat4& pose, const glm::dvec3& direction,
                    double by_m) {
  CloudTruth nearest;
  const reference::MeshRay in_mesh = reference::ray_in_mesh(place, pose, direction);
  ExactSurface shape = *cloud.surface;
  shape.radius_m += by_m;
  for (std::uint32_t i = 0; i < cloud.indices.size(); ++i) {
    const glm::dvec3 middle(cloud.positions[i]), normal(cloud.attributes[i].normal);
    reference::MeshRay around = in_mesh;
    for (int axis = 0; axis < 3; ++axis) around.from[axis] -= reference::Quad(middle[axis]);
    const reference::Quad range_m = is_cloud_of_discs(cloud)
                                        ? reference::range_to_disc(in_mesh, middle, normal, shape.radius_m)
                                        : reference::ShapeRay(shape, around).nearest().range_m;
    if (range_m < nearest.range_m) nearest = {range_m, i};
  }
  return nearest;
}

// Random rays into random clouds, against closed forms.
void check_cloud_rays(SurfaceKind kind, std::mt19937& random) {
  const RayEngine engine = each_engine();
  const auto rays = static_cast<std::size_t>(count_of("SIMVIS_TEST_CLOUD_RAYS", 3000));
  std::size_t cast = 0, hits = 0, wrong = 0, beyond = 0, doubtful = 0;
  double worst_rel = 0;
  while (cast < rays) {
    const Mesh cloud = cloud_of(60, 0.02 + 0.1 * (random() % 3), random, kind);
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

}  // namespace

TEST_CASE("random rays meet the spheres of a cloud where closed forms say, within their bounds") {
  std::mt19937 random(31);
  check_cloud_rays(SurfaceKind::sphere, random);
}

TEST_CASE("random rays meet the discs of a cloud where closed forms say, within their bounds") {
  std::mt19937 random(36);
  check_cloud_rays(SurfaceKind::disc, random);
}

TEST_CASE("a disc is met from both sides up to its edge, not behind the sensor and not along itself") {
  const RayEngine engine = each_engine();
  Mesh cloud;
  cloud.topology = Topology::points;
  cloud.positions = {{2, 0, 0}};
  cloud.attributes = {{.normal = glm::normalize(glm::vec3(-1, 0, 1))}};
  cloud.indices = {0};
  cloud.surface = ExactSurface{.kind = SurfaceKind::disc, .radius_m = 0.5};
  compute_bounds(cloud);
  const DrawList list = list_with(cloud, glm::dmat4(1)), high = list_with(cloud, glm::scale(glm::dmat4(1), {1, 1, 4}));
  // The disc lies in x - z = 2. A ray along x at the height z meets it at x = 2 + z while sqrt(2) |z| <= 0.5.
  const double edge_m = 0.5 / std::numbers::sqrt2;
  constexpr double kRounding_m = 1e-7;  // of the normal, which is float32
  const auto range_at = [&](const DrawList& into, double x, double z, double way) {
    return engine.cast_one(into, {way, 0, 0}, at(x, 0, z)).range_m;
  };
  CHECK(std::abs(range_at(list, 0, 0, 1) - 2) < kRounding_m);
  CHECK(std::abs(range_at(list, 0, 0.3, 1) - 2.3) < kRounding_m);
  CHECK(std::abs(range_at(list, 0, -0.3, 1) - 1.7) < kRounding_m);
  CHECK(std::abs(range_at(list, 5, 0.3, -1) - 2.7) < kRounding_m);
  CHECK(range_at(list, 0, edge_m - kRounding_m, 1) < kInfinity);
  CHECK(range_at(list, 0, edge_m + kRounding_m, 1) == kInfinity);
  CHECK(range_at(list, 2.4, 0.3, 1) == kInfinity);  // behind the sensor
  CHECK(range_at(list, 2.2, 0.3, 1) < kInfinity);   // the sensor is below the disc, which rises before it
  CHECK(std::abs(range_at(high, 0, 1.2, 1) - 2.3) < kRounding_m);  // four times as high
  CHECK(range_at(high, 0, 4 * (edge_m + kRounding_m), 1) == kInfinity);
  // Along itself, in its plane and beside it.
  const glm::dvec3 along = glm::normalize(glm::dvec3(1, 0, 1));
  CHECK(engine.cast_one(list, {0, 1, 0}, at(2, -3, 0)).range_m == kInfinity);
  CHECK(engine.cast_one(list, along, at(0, 0, 0)).range_m == kInfinity);
  const RayHit hit = engine.cast_one(list, {1, 0, 0}, at(0, 0, 0.1));
  const SurfacePoint point = surface_point(list, at(0, 0, 0.1), {1, 0, 0}, hit);
  CHECK(glm::length(glm::cross(point.normal, glm::dvec3(cloud.attributes[0].normal))) <= kRounding_m);
}

// A ray at the slant s meets a disc at a range that rounding moves by about u / s.
TEST_CASE("rays that graze a disc are within their bounds, which grow with the slant up to the size of the disc") {
  const RayEngine engine = each_engine();
  std::mt19937 random(37);
  constexpr double kRadius_m = 0.5, kAway_m = 3;
  for (const glm::dvec3& scale : {glm::dvec3(1), glm::dvec3(-1, 1, 1), glm::dvec3(0.5, 2, 3)}) {
    double median_before_m = 0;
    for (const double slant : {1.0, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14}) {
      CAPTURE(slant);
      std::vector<double> bounds_m;
      int wrong = 0, beyond = 0;
      for (int i = 0; i < 200; ++i) {
        Mesh cloud = cloud_of(1, kRadius_m, random, SurfaceKind::disc);
        const glm::dmat4 place = glm::scale(random_pose(random, 3), scale);
        // In the frame of the mesh: from beside the disc to a point on it, by the normal as float32 has it.
        const glm::dvec3 n(cloud.attributes[0].normal), middle(cloud.positions[0]);
        const glm::dvec3 along = glm::normalize(glm::cross(n, random_direction(random)));
        const glm::dvec3 aside = glm::normalize(glm::cross(n, along));
        const double beside = std::uniform_real_distribution<double>(-0.9, 0.9)(random);
        const glm::dvec3 way = glm::normalize(along - slant * glm::normalize(n));
        const glm::dvec3 on_disc = middle + kRadius_m * beside * aside;
        glm::dmat4 pose = random_pose(random, 0);
        pose[3] = place * glm::dvec4(on_disc - kAway_m * way, 1);
        const glm::dvec3 direction = glm::normalize(glm::transpose(glm::dmat3(pose)) * (glm::dmat3(place) * way));
        const RayHit hit = engine.cast_one(list_with(cloud, place), direction, pose);
        const auto exact_m = static_cast<double>(truth_of(cloud, place, pose, direction, 0).range_m);
        // The height of the ray over the disc is off by at most the doubt of all lengths, here 100 m.
        constexpr double kHeightDoubt_m = kCloudDoubt_rel * 100;
        const double chord_m = glm::length(glm::dmat3(place) * way) * kRadius_m * std::sqrt(1 - beside * beside);
        const bool may_miss = kHeightDoubt_m / slant > 0.1 * chord_m;
        if (hit.range_m < kInfinity && exact_m < kInfinity) {
          beyond += std::abs(hit.range_m - exact_m) > hit.error_bound_m;
          bounds_m.push_back(hit.error_bound_m);
        } else {
          wrong += !may_miss;
        }
        // No two points of the disc are farther apart than this: the sum of the squares of three axes.
        if (hit.range_m < kInfinity) CHECK(hit.error_bound_m <= 2 * kRadius_m * glm::length(scale) * (1 + 1e-9));
      }
      CHECK(wrong == 0);
      CHECK(beyond == 0);
      REQUIRE(bounds_m.size() > 20);
      std::ranges::nth_element(bounds_m, bounds_m.begin() + static_cast<std::ptrdiff_t>(bounds_m.size() / 2));
      const double median_m = bounds_m[bounds_m.size() / 2];
      CHECK(median_m >= median_before_m);
      median_before_m = median_m;
    }
    CHECK(median_before_m > kRadius_m);  // at the slant of 1e-14 the place on the disc is not known
  }
}

TEST_CASE("a cloud has the hits of its discs as items of their own, by every way of casting") {
  std::mt19937 random(38);
  for (const std::size_t points : {1u, 700u, 5000u}) {
    CAPTURE(points);
    const Mesh cloud = cloud_of(points, 0.03, random, SurfaceKind::disc);
    const glm::dmat4 place = glm::scale(at(0.25, 0, 0), {1, -2, 1});
    const DrawList list = list_with(cloud, place);
    DrawList single;
    for (std::size_t i = 0; i < points; ++i) {
      Mesh one = cloud;
      one.positions = {cloud.positions[i]};
      one.attributes = {cloud.attributes[i]};
      one.indices = {0};
      compute_bounds(one);
      add_item(single, one, place);
    }
    const glm::dmat4 pose = at(-4, 0.3, 0.2);
    const std::vector<glm::dvec3> directions = directions_at(cloud, place, pose, 2000, random);
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
      const bool is_hit = hits[i].range_m < kInfinity;
      other += hits[i].range_m != expected[i].range_m || hits[i].error_bound_m != expected[i].error_bound_m ||
               (is_hit && hits[i].primitive != expected[i].item);
      found += is_hit;
    }
    CHECK(other == 0);
    CHECK(found > (points == 1 ? 100 : hits.size() / 4));
  }
}

TEST_CASE("normals of discs are those of their points under any transform, on the side that is seen") {
  std::mt19937 random(39);
  const Mesh cloud = cloud_of(200, 0.2, random, SurfaceKind::disc);
  const glm::dmat4 place = glm::scale(at(1, 2, 3), {-1, 2, 0.5}), pose = at(-4, 2, 3);
  const DrawList list = list_with(cloud, place);
  const glm::dmat3 of_normals = glm::transpose(glm::inverse(glm::dmat3(place)));
  std::size_t hits = 0;
  for (const glm::dvec3& direction : directions_at(cloud, place, pose, 300, random)) {
    const RayHit hit = host_engine().cast_one(list, direction, pose);
    if (hit.range_m == kInfinity) continue;
    const SurfacePoint point = surface_point(list, pose, direction, hit);
    const glm::dvec3 normal = glm::normalize(of_normals * glm::dvec3(cloud.attributes[hit.primitive].normal));
    constexpr double kOwn_rad = 1e-14;  // of the expected normal
    CHECK(glm::length(glm::cross(point.normal, normal)) <= point.normal_error_rad + kOwn_rad);
    CHECK(point.normal_error_rad < 1e-12);
    CHECK(glm::dot(point.normal, direction) < 0);
    CHECK(point.base_color == cloud.attributes[hit.primitive].color);
    ++hits;
  }
  CHECK(hits > 100);
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
