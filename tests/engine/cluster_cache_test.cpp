#include "engine/geometry/cluster_cache.h"

#include <doctest/doctest.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <numeric>
#include <random>

#include <simvis/device.h>
#include "engine/base/cache_file.h"
#include "engine/render/renderer.h"
#include "tests/support/random_room.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kClusterHeaderBytes = 40, kClusterChecksumAt = 32;

// The triangles of a sphere in random order.
Mesh shuffled_sphere() {
  constexpr int kSegments = 258;
  Mesh mesh = sphere_mesh(3, kSegments);
  std::vector<std::uint32_t> order(mesh.indices.size() / 3), indices;
  REQUIRE(order.size() >= kMinCachedTriangles);
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  for (const std::size_t t : order)
    indices.insert(indices.end(), {mesh.indices[3 * t], mesh.indices[3 * t + 1], mesh.indices[3 * t + 2]});
  mesh.indices = indices;
  return mesh;
}

bool same(const Clustering& a, const Clustering& b) {
  return a.vertices == b.vertices && a.corners == b.corners &&
         std::ranges::equal(a.clusters, b.clusters, [](const Cluster& x, const Cluster& y) {
           return x.first_index == y.first_index && x.index_count == y.index_count && x.center == y.center &&
                  x.half_size == y.half_size;
         });
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  return files;
}

std::string read_cache(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// A file that contains `order` and is correct otherwise.
std::string with_order(const std::string& good, const std::vector<std::uint32_t>& order) {
  std::string bytes = good.substr(0, kClusterHeaderBytes);
  bytes.append(reinterpret_cast<const char*>(order.data()), order.size() * sizeof order[0]);
  const std::uint64_t checksum = cache_checksum(std::string_view(bytes).substr(kClusterHeaderBytes));
  std::memcpy(bytes.data() + kClusterChecksumAt, &checksum, sizeof checksum);
  return bytes;
}

FramePlan plan_of(std::uint32_t width_px, std::uint32_t height_px) {
  View view;
  view.pinhole = {256, 256, width_px / 2.0, height_px / 2.0};
  view.near_m = 1e-3;
  view.width_px = width_px;
  view.height_px = height_px;
  view.sees_back_faces = true;
  FramePlan plan;
  plan.passes.push_back(
      {.name = "pass", .width_px = width_px, .height_px = height_px, .color = false, .depth = true, .views = {view}});
  return plan;
}

DeviceDesc with_cache(const fs::path& folder) {
  DeviceDesc desc;
  desc.cache_dir = folder.string();
  return desc;
}

std::vector<float> depth_of(const DrawList& list, const fs::path& cache, const FramePlan& plan) {
  Device device(with_cache(cache));
  Renderer renderer(device);
  const auto depth = renderer.render(list, plan)[0].depth;
  return {depth.begin(), depth.end()};
}

}  // namespace

TEST_CASE("the order of a mesh's clusters is kept, and a damaged file is replaced") {
  const TemporaryFolder folder;
  const Mesh mesh = shuffled_sphere();
  const Clustering expected = make_clusters(mesh);
  CHECK(same(make_clusters_cached(mesh, folder.path()), expected));
  REQUIRE(files_in(folder.path()).size() == 1);
  const fs::path file = files_in(folder.path())[0];
  const std::string good = read_cache(file);
  REQUIRE(good.size() == kClusterHeaderBytes + mesh.indices.size() / 3 * sizeof(std::uint32_t));

  // It is used, so it is not written again.
  const auto long_ago = fs::last_write_time(file) - std::chrono::hours(1);
  fs::last_write_time(file, long_ago);
  CHECK(same(make_clusters_cached(mesh, folder.path()), expected));
  CHECK(fs::last_write_time(file) == long_ago);

  const auto remade = [&](const std::string& bytes) {
    write_text(file, bytes);
    return same(make_clusters_cached(mesh, folder.path()), expected) && files_in(folder.path()).size() == 1 &&
           read_cache(file) == good;
  };
  CHECK(remade(""));
  CHECK(remade(good + "x"));
  for (const std::size_t size : {std::size_t{1}, kClusterHeaderBytes, good.size() - 1})
    CHECK(remade(good.substr(0, size)));
  for (const std::size_t byte : {std::size_t{0}, std::size_t{7}, std::size_t{9}, std::size_t{25}, kClusterChecksumAt,
                                 kClusterHeaderBytes, good.size() - 1}) {
    CAPTURE(byte);
    std::string bad = good;
    bad[byte] = static_cast<char>(bad[byte] ^ 0x10);
    CHECK(remade(bad));
  }
  std::vector<std::uint32_t> order(mesh.indices.size() / 3);
  std::iota(order.begin(), order.end(), 0u);
  order[5] = 6;
  CHECK(remade(with_order(good, order)));  // one triangle twice, another one never
  order[5] = static_cast<std::uint32_t>(order.size());
  CHECK(remade(with_order(good, order)));
}

TEST_CASE("a cached order that is not optimal costs time but loses no triangles") {
  const TemporaryFolder folder;
  const Mesh mesh = shuffled_sphere();
  make_clusters_cached(mesh, folder.path());
  const fs::path file = files_in(folder.path())[0];
  std::vector<std::uint32_t> order(mesh.indices.size() / 3);
  std::iota(order.begin(), order.end(), 0u);
  write_text(file, with_order(read_cache(file), order));
  const Clustering clustering = make_clusters_cached(mesh, folder.path());
  std::size_t next = 0;
  for (const Cluster& cluster : clustering.clusters) {
    const ClusterVertices vertices = clustering.vertices_of(cluster);
    for (const std::uint8_t corner : clustering.corners_of(cluster)) {
      if (vertices[corner] != mesh.indices[next++]) FAIL("not in the order that the file says");
      const glm::dvec3 off = glm::abs(glm::dvec3(mesh.positions[vertices[corner]]) - glm::dvec3(cluster.center));
      if (!glm::all(glm::lessThanEqual(off, glm::dvec3(cluster.half_size)))) FAIL("a corner outside its cluster's box");
    }
  }
  CHECK(next == mesh.indices.size());
}

TEST_CASE("each content has its own file; small meshes have none, and a missing folder is no error") {
  const TemporaryFolder folder;
  Mesh mesh = shuffled_sphere();
  make_clusters_cached(mesh, folder.path());
  mesh.positions[0].x += 1;
  make_clusters_cached(mesh, folder.path());
  std::swap(mesh.indices[0], mesh.indices[1]);
  CHECK(same(make_clusters_cached(mesh, folder.path()), make_clusters(mesh)));
  CHECK(files_in(folder.path()).size() == 3);
  make_clusters_cached(sphere_mesh(1, 40), folder.path());
  CHECK(files_in(folder.path()).size() == 3);
  write_text(folder / "file", "");
  CHECK(same(make_clusters_cached(mesh, folder / "file/below"), make_clusters(mesh)));
  CHECK(same(make_clusters_cached(mesh, {}), make_clusters(mesh)));
}

TEST_CASE(
    "a picture has the same bytes with and without a cache; meshes that are added later are not written to disk") {
  const TemporaryFolder folder;
  DrawList list;
  add_item(list, shuffled_sphere(), glm::translate(glm::dmat4(1.0), {0.5, 0.2, 1}));
  for (const std::uint32_t height_px : {2u, 80u}) {
    const FramePlan plan = plan_of(256, height_px);
    const std::vector<float> without = depth_of(list, "/dev/null/none", plan);
    CHECK(depth_of(list, folder.path(), plan) == without);
    CHECK(depth_of(list, folder.path(), plan) == without);
  }
  const auto cached = [&] {
    return std::ranges::count_if(files_in(folder.path()), [](const fs::path& file) {
      return file.filename().string().starts_with("clusters-");
    });
  };
  CHECK(cached() == 1);
  Device device(with_cache(folder.path()));
  Renderer renderer(device);
  renderer.render(list, plan_of(256, 80));
  Mesh moved = shuffled_sphere();
  for (glm::vec3& position : moved.positions) position.x += 0.25f;
  add_item(list, std::move(moved), glm::dmat4(1.0));
  renderer.render(list, plan_of(256, 80));
  CHECK(renderer.counters().meshes_held == 2);
  CHECK(cached() == 1);
}

TEST_CASE("meshes loaded at once take only their size on the device, and growth adds half of it") {
  Device device;
  Renderer renderer(device);
  DrawList list;
  const auto ratio = [&] {
    FramePlan plan = plan_of(64, 64);
    renderer.render(list, plan);
    renderer.complete(plan);
    std::uint64_t bytes = 0;
    for (const PlannedMemory& memory : plan.memory) bytes += memory.name.starts_with("mesh ") ? memory.bytes : 0;
    return static_cast<double>(bytes) / static_cast<double>(renderer.counters().mesh_bytes);
  };
  // The device rounds the size of each of the two buffers up, to 256 bytes at most.
  constexpr double kRounding = 1e-3;
  add_item(list, shuffled_sphere(), glm::dmat4(1.0));
  CHECK(ratio() <= 1 + kRounding);
  for (int i = 1; i < 4; ++i) {
    add_item(list, shuffled_sphere(), glm::dmat4(1.0));
    CHECK(ratio() <= 1.5 + kRounding);
  }
}

TEST_SUITE_END();
