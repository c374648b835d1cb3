#include "engine/geometry/clusters.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <set>

#include <simvis/device.h>
#include "engine/draw/grid_mesh.h"
#include "engine/geometry/cluster_cache.h"
#include "engine/render/renderer.h"
#include "scenegraph/height_map.h"
#include "tests/support/random_room.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

std::vector<std::array<std::uint32_t, 3>> sorted_triangles(const std::vector<std::uint32_t>& indices) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t i = 0; i < indices.size(); i += 3) triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  std::ranges::sort(triangles);
  return triangles;
}

// The vertices of the mesh, cluster by cluster.
std::vector<std::uint32_t> indices_of(const Clustering& clustering) {
  std::vector<std::uint32_t> indices;
  for (const Cluster& cluster : clustering.clusters) {
    const ClusterVertices vertices = clustering.vertices_of(cluster);
    for (const std::uint8_t corner : clustering.corners_of(cluster)) indices.push_back(vertices[corner]);
  }
  return indices;
}

// Sorts numbers only, one half after the other.
void sort_plainly(const std::vector<glm::vec3>& centers, std::span<std::uint32_t> triangles) {
  if (triangles.size() <= kClusterTriangles) return;
  glm::vec3 low = centers[triangles[0]], high = low;
  for (const std::uint32_t t : triangles) {
    low = glm::min(low, centers[t]);
    high = glm::max(high, centers[t]);
  }
  const glm::vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t middle = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(middle), triangles.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
                   });
  sort_plainly(centers, triangles.first(middle));
  sort_plainly(centers, triangles.subspan(middle));
}

FramePlan plan_of(double yaw_rad, std::uint32_t width_px, std::uint32_t height_px) {
  View view;
  view.pinhole = {256, 256, width_px / 2.0, height_px / 2.0};
  view.near_m = 1e-3;
  view.view_from_world = glm::rotate(glm::dmat4(1.0), yaw_rad, glm::dvec3(0, 1, 0));
  view.width_px = width_px;
  view.height_px = height_px;
  view.sees_back_faces = true;
  FramePlan plan;
  plan.passes.push_back(
      {.name = "pass", .width_px = width_px, .height_px = height_px, .color = false, .depth = true, .views = {view}});
  return plan;
}

void check_clusters(const Mesh& mesh, const Clustering& clustering) {
  REQUIRE(clustering.clusters.size() > 10);
  const std::vector<std::uint32_t> indices = indices_of(clustering);
  CHECK(sorted_triangles(indices) == sorted_triangles(mesh.indices));
  std::uint32_t next = 0;
  for (const Cluster& cluster : clustering.clusters) {
    CHECK(cluster.first_index == next);
    CHECK(cluster.index_count > 0);
    CHECK(cluster.index_count <= 3 * kClusterTriangles);
    next += cluster.index_count;
    for (std::uint32_t i = cluster.first_index; i < next; ++i) {
      const glm::dvec3 off = glm::abs(glm::dvec3(mesh.positions[indices[i]]) - glm::dvec3(cluster.center));
      CHECK(glm::all(glm::lessThanEqual(off, glm::dvec3(cluster.half_size))));
    }
  }
  CHECK(next == mesh.indices.size());
}

}  // namespace

TEST_CASE("clusters hold every triangle once, a few each, within their boxes") {
  const Mesh mesh = sphere_mesh(2, 90);
  check_clusters(mesh, make_clusters(mesh));
}

TEST_CASE("a grid of heights is cut into clusters of neighbours without sorting, and without a file") {
  constexpr std::uint32_t kLong = kMinGridCells + 1;
  for (const glm::uvec2 size : {glm::uvec2(600, 500), glm::uvec2(2, kLong), glm::uvec2(kLong, 2)}) {
    CAPTURE(size.x);
    HeightPicture picture{.width = size.x, .height = size.y, .values = {}};
    for (std::uint32_t i = 0; i < size.x * size.y; ++i) picture.values.push_back(static_cast<float>(i % 7));
    const Mesh mesh = height_map(picture, {size.x, size.y}, 0, 1e-3).mesh;  // cells of a metre
    REQUIRE(find_grid(mesh));
    const TemporaryFolder folder;
    const Clustering clustering = make_clusters_cached(mesh, folder.path());
    check_clusters(mesh, clustering);
    CHECK(std::filesystem::is_empty(folder.path()));
    // 16 cells of a row, or 5 x 3 of a square; halving leaves more than half of that. A box has two ulps of its farther
    // corner more on each side, and that corner is at most half the grid away.
    const double ulps_m = 2 * std::numeric_limits<float>::epsilon() * std::max(size.x, size.y);
    const double longest_m = (std::min(size.x, size.y) > 2 ? 5 : 16) + 1.5 * ulps_m;
    for (const Cluster& cluster : clustering.clusters) {
      CHECK(cluster.index_count > 3 * kClusterTriangles / 2 - 1);
      CHECK(2 * std::max(cluster.half_size.x, cluster.half_size.y) <= longest_m);
    }
    // So many sizes at most: parts that are halved as often differ by one, and some are halved once more.
    CHECK(clustering.corners.size() <= 4 * 4 * 3 * kClusterTriangles);
    CHECK(clustering.vertices.size() <= clustering.corners.size());
  }
}

TEST_CASE("a cluster lists each of its vertices once, and no list has spare capacity") {
  const Clustering clustering = make_clusters(sphere_mesh(2, 90));
  std::uint32_t next_vertex = 0;
  for (const Cluster& cluster : clustering.clusters) {
    CHECK(cluster.first_vertex == next_vertex);
    next_vertex += cluster.vertex_count;
    const std::span<const std::uint32_t> vertices = clustering.vertices_of(cluster).offsets;
    CHECK(std::set<std::uint32_t>(vertices.begin(), vertices.end()).size() == vertices.size());
  }
  CHECK(next_vertex == clustering.vertices.size());
  // On a grid of triangles every vertex belongs to six of them: of 16 to 32 neighbours, at most one each.
  CHECK(clustering.vertices.size() <= clustering.corners.size() / 3);
  CHECK(clustering.vertices.capacity() == clustering.vertices.size());
  CHECK(clustering.corners.capacity() == clustering.corners.size());
  CHECK(clustering.clusters.capacity() == clustering.clusters.size());
}

TEST_CASE("several threads sort triangles in the same order as one thread that sorts numbers") {
  const Mesh mesh = sphere_mesh(2, 200);  // enough for more than one thread
  std::vector<glm::vec3> centers(mesh.indices.size() / 3);
  std::vector<std::uint32_t> expected(centers.size());
  for (std::uint32_t t = 0; t < centers.size(); ++t) {
    expected[t] = t;
    for (int corner = 0; corner < 3; ++corner) centers[t] += mesh.positions[mesh.indices[3 * t + corner]] / 3.0f;
  }
  sort_plainly(centers, expected);
  CHECK(order_in_space(mesh) == expected);
}

TEST_CASE("a mesh of many triangles at one place still gets small clusters") {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  for (int i = 0; i < 1000; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1, 2});
  for (const Cluster& cluster : make_clusters(mesh).clusters) CHECK(cluster.index_count <= 3 * kClusterTriangles);
}

TEST_CASE("lines are one cluster in their order") {
  Mesh mesh;
  mesh.topology = Topology::lines;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}};
  for (int i = 0; i < 1000; ++i) mesh.indices.insert(mesh.indices.end(), {0, 1});
  const Clustering clustering = make_clusters(mesh);
  REQUIRE(clustering.clusters.size() == 1);
  CHECK(clustering.clusters[0].index_count == mesh.indices.size());
  CHECK(clustering.clusters[0].half_size.x >= 0.5f);
  CHECK((clustering.vertices.empty() && clustering.corners.empty()));
}

TEST_CASE("drawing only the visible part of a mesh gives the same bytes as drawing every triangle separately") {
  Device device;
  const Mesh mesh = sphere_mesh(3, 120);
  const glm::dmat4 pose = glm::rotate(glm::translate(glm::dmat4(1.0), {0.5, 0.2, 1}), 0.4, {1, 2, 3});
  DrawList whole, apart;
  add_item(whole, mesh, pose);
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    Mesh triangle;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      triangle.positions.push_back(mesh.positions[mesh.indices[i + corner]]);
    }
    triangle.indices = {0, 1, 2};
    add_item(apart, triangle, pose);
  }
  Renderer renderer(device), other(device);
  // A strip is reduced to its triangles, a picture to its clusters.
  for (const std::uint32_t height_px : {2u, 80u}) {
    for (const double yaw : {0.0, 1.0, 2.5, 4.0}) {
      const FramePlan plan = plan_of(yaw, 512, height_px);
      const auto depth = renderer.render(whole, plan)[0].depth;
      const FrameCounters counters = renderer.counters();
      const auto expected = other.render(apart, plan)[0].depth;
      CHECK(std::ranges::equal(depth, expected));
      CHECK(std::ranges::count(depth, 0.0f) < static_cast<std::ptrdiff_t>(depth.size()));
      CHECK(counters.triangles < mesh.indices.size() / 3 / 2);  // the sphere is all around
    }
  }
}

TEST_SUITE_END();
