// The host's ray caster on several threads: the same hits on any number of them, and by several casters at once.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include <simvis/ray_caster.h>
#include "engine/base/thread_pool.h"
#include "engine/geometry/clusters.h"
#include "engine/geometry/wide_bvh.h"
#include "engine/raycast/blas.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("engine/raycast");

namespace simvis {
namespace {

// What is expected is made on one thread. The sanitizers make everything about twenty times slower.
const std::vector<unsigned> kThreads = sanitized() ? std::vector{3u} : std::vector{2u, 3u, 8u};
// Above these sizes a tree is built, and a mesh is sorted, on several threads: see bvh.cpp and clusters.cpp.
constexpr std::size_t kTriangles = 110'000;

/// Patches that overlap at random, so that a wrong tree would be noticed.
Mesh random_triangles(std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-5, 5), edge(-0.1f, 0.1f);
  Mesh mesh;
  for (std::size_t t = 0; t < count; ++t) {
    const glm::vec3 corner(place(random), place(random), place(random));
    mesh.positions.push_back(corner);
    for (int k = 0; k < 2; ++k) mesh.positions.push_back(corner + glm::vec3(edge(random), edge(random), edge(random)));
    for (std::uint32_t k = 0; k < 3; ++k) mesh.indices.push_back(static_cast<std::uint32_t>(3 * t + k));
  }
  mesh.attributes.resize(mesh.positions.size());
  mesh.bounds_min = glm::vec3(std::numeric_limits<float>::infinity());
  mesh.bounds_max = -mesh.bounds_min;
  for (const glm::vec3& p : mesh.positions) {
    mesh.bounds_min = glm::min(mesh.bounds_min, p);
    mesh.bounds_max = glm::max(mesh.bounds_max, p);
  }
  return mesh;
}

DrawList one_item(Mesh mesh) {
  DrawList list;
  list.meshes.push_back(std::make_shared<const Mesh>(std::move(mesh)));
  list.materials.push_back(std::make_shared<const Material>());
  list.material_revision.push_back(0);
  list.world_from_node.emplace_back(1.0);
  list.items.push_back({.mesh = 0, .material = 0, .transform = 0});
  return list;
}

std::vector<glm::dvec3> random_directions(std::size_t count) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> directions;
  while (directions.size() < count) {
    const double x = normal(random), y = normal(random), z = normal(random);
    directions.push_back(glm::normalize(glm::dvec3(x, y, z)));
  }
  return directions;
}

std::vector<RayHit> hits_of(RayCaster& caster, const DrawList& list, const std::vector<glm::dvec3>& directions) {
  std::vector<RayHit> hits(directions.size());
  caster.set_world(list);
  caster.cast(glm::dmat4(1.0), directions, hits);
  return hits;
}

std::vector<RayHit> cast_with(unsigned threads, const DrawList& list, const std::vector<glm::dvec3>& directions) {
  return hits_of(*make_host_ray_caster({}, threads), list, directions);
}

TEST_CASE("hits are the same on any number of threads") {
  const DrawList list = one_item(random_triangles(kTriangles));
  const std::vector<glm::dvec3> directions = random_directions(20'000);
  const std::vector<RayHit> expected = cast_with(1, list, directions);
  CHECK(std::ranges::count_if(expected, [](const RayHit& hit) { return std::isfinite(hit.range_m); }) > 1000);
  for (const unsigned threads : kThreads) {
    CAPTURE(threads);
    CHECK(cast_with(threads, list, directions) == expected);
  }
}

TEST_CASE("casters in different threads do not disturb one another") {
  const DrawList list = one_item(random_triangles(kTriangles / 10));
  const std::vector<glm::dvec3> directions = random_directions(4'000);
  const std::vector<RayHit> expected = cast_with(1, list, directions);
  constexpr int kCasts = 3;
  for (const unsigned threads : kThreads) {
    CAPTURE(threads);
    std::vector<int> same(4);
    std::vector<std::jthread> callers;
    for (int& mine : same) {
      callers.emplace_back([&] {
        const std::unique_ptr<RayCaster> caster = make_host_ray_caster({}, threads);
        for (int round = 0; round < kCasts; ++round) mine += hits_of(*caster, list, directions) == expected;
      });
    }
    callers.clear();
    CHECK(same == std::vector<int>(4, kCasts));
  }
}

TEST_CASE("casters with threads of their own share the tree of a mesh, while one of them is there") {
  const DrawList list = one_item(random_triangles(kTriangles));
  const std::vector<glm::dvec3> directions = random_directions(4'000);
  std::vector<std::vector<RayHit>> hits(4);
  std::weak_ptr<const Blas> shared;
  {
    const std::shared_ptr<const Blas> first = shared_blas(list.meshes[0], {}, shared_thread_pool(2));
    shared = first;
    std::vector<std::jthread> callers;
    for (unsigned threads = 1; threads <= hits.size(); ++threads) {
      callers.emplace_back([&, threads] { hits[threads - 1] = cast_with(threads, list, directions); });
    }
    callers.clear();
    CHECK(shared_blas(list.meshes[0], {}, shared_thread_pool(1)) == first);
  }
  CHECK(shared.expired());
  for (const std::vector<RayHit>& mine : hits) CHECK(mine == cast_with(1, list, directions));
}

TEST_CASE("trees and orders of triangles are the same on any number of threads") {
  const Mesh mesh = random_triangles(kTriangles);
  std::vector<Box> boxes;
  for (std::size_t t = 0; t < kTriangles; ++t) {
    const glm::vec3 &a = mesh.positions[3 * t], &b = mesh.positions[3 * t + 1], &c = mesh.positions[3 * t + 2];
    boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
  }
  const Bvh expected = build_bvh(boxes, 4);
  const std::vector<std::uint32_t> expected_order = order_in_space(mesh);
  for (const unsigned threads : kThreads) {
    CAPTURE(threads);
    ThreadPool pool(threads);
    const Bvh tree = build_bvh(boxes, 4, 1, &pool);
    CHECK(tree.nodes == expected.nodes);
    CHECK(tree.order == expected.order);
    CHECK(order_in_space(mesh, &pool) == expected_order);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
