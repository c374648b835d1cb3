// Tests of the benchmark scenes: number of triangles, closed rooms, and unchanged surfaces after subdivision.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bench/scenes/finer_part.h"
#include "bench/scenes/glb_file.h"
#include "bench/scenes/lab.h"
#include "bench/scenes/scene_folder.h"
#include "bench/scenes/solids.h"

namespace simvis::bench {
namespace {

constexpr const char* kLidar =
    R"(<sensor type="laser_scanner" name="LIDAR" insert_at="ROBOT" pose_offset="0 0 1.2 0 0 0" method="raycast"
       samples="90" min_angle="-180" max_angle="176" vertical_samples="16" vertical_min_angle="-60"
       vertical_max_angle="60"/>)";

std::vector<float> scan_part(const std::filesystem::path& folder, const std::string& file, std::size_t& triangles) {
  Simulation simulation = Simulation::from_string("<part file=\"" + file + R"(" name="PART" insert_at="ROOT" up="z"/>
      <sensor type="laser_scanner" name="LIDAR" insert_at="PART" ignore="none" pose_offset="0.3 -0.2 0.1 5 10 20" method="raycast"
              samples="91" min_angle="-180" max_angle="170" vertical_samples="9" vertical_min_angle="-70"
              vertical_max_angle="70"/>)",
                                                  {}, folder);
  simulation.step();
  triangles = triangles_of(simulation.diagnostics().draw_list());
  return simulation.scan("LIDAR").range_m;
}

}  // namespace

TEST_CASE("a lab has as many triangles as asked for, and no hole") {
  for (const std::size_t asked : {1'000, 10'000, 100'000}) {
    CAPTURE(asked);
    const SceneFolder folder;
    Simulation simulation = Simulation::load(write_lab(folder.path(), asked, kLidar));
    drive_lab(simulation, 40);
    simulation.step();
    // A box of t triangles has sqrt(t / 12) cells along an edge, rounded by at most half a cell. Spheres and cylinders
    // have finer grids. There are at most 200 items with nine tenths of the triangles.
    const double per_item = 0.9 * static_cast<double>(asked) / std::min(200.0, static_cast<double>(asked) / 45);
    const double cells = std::sqrt(per_item / 12);
    const double most = std::pow(1 + 0.5 / cells, 2), least = std::pow(1 - 0.5 / cells, 2);
    const double met =
        static_cast<double>(triangles_of(simulation.diagnostics().draw_list())) / static_cast<double>(asked);
    CHECK(met < most);
    CHECK(met > least);
    CHECK(std::ranges::all_of(simulation.scan("LIDAR").range_m, [](float r) { return r > 0 && std::isfinite(r); }));
  }
}

TEST_CASE("labs are the same each time, and their robot drives") {
  const SceneFolder folder;
  std::uint64_t hashes[2] = {};
  for (std::uint64_t& hash : hashes) {
    Simulation simulation = Simulation::load(write_lab(folder.path(), 2'000));
    simulation.step();
    hash = content_hash(simulation.diagnostics().draw_list());
    glm::dmat4 before(1.0), after(1.0);
    simulation.sensor_pose("FRONT_SCANNER", before);
    drive_lab(simulation, 90);
    simulation.step();
    simulation.sensor_pose("FRONT_SCANNER", after);
    CHECK(glm::distance(glm::dvec3(before[3]), glm::dvec3(after[3])) > 1);
  }
  CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("a store holds its instances as one mesh, and all except the first hundred are out of sight") {
  constexpr std::size_t kInstances = 300, kNear = 100;
  const SceneFolder folder;
  Simulation simulation = Simulation::load(write_store(folder.path(), kInstances));
  simulation.step();
  const DrawList& list = simulation.diagnostics().draw_list();
  std::vector<std::size_t> uses(list.meshes.size()), low(list.meshes.size());
  for (const DrawItem& item : list.items) {
    ++uses[item.mesh];
    low[item.mesh] += list.world_from_node[item.transform][3].z < 3;
  }
  const auto most = std::ranges::max_element(uses) - uses.begin();
  CHECK(uses[static_cast<std::size_t>(most)] == kInstances);
  CHECK(low[static_cast<std::size_t>(most)] == kNear);
}

TEST_CASE("a part that is cut finer has the same surface") {
  constexpr int kParts = 3;
  const glm::dvec3 size_m(4.1, 3.3, 2.7);
  const SceneFolder folder;
  const std::vector<Mesh> box = {box_of(size_m, 12)};
  const std::vector<PlacedMesh> placed = {{}};
  write_glb(folder.path() / "box.glb", box, placed);
  write_finer_part(folder.path() / "box.glb", folder.path() / "finer.glb", kParts);
  std::size_t triangles = 0, finer = 0;
  const std::vector<float> ranges_m = scan_part(folder.path(), "box.glb", triangles);
  const std::vector<float> finer_m = scan_part(folder.path(), "finer.glb", finer);
  CHECK(triangles == 12);
  CHECK(finer == triangles * kParts * kParts);
  REQUIRE(ranges_m.size() == finer_m.size());
  // A new vertex is rounded by half an ulp of each coordinate, 2^-24 of at most 2.05 m, and so may its plane be. From
  // near the middle, no wall is hit more than 80 degrees off its normal. The range is rounded as well.
  const double vertex_m = std::sqrt(3.0) * 0x1p-24 * 2.05, slant = 1 / std::cos(80 * 3.14159 / 180);
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    CHECK(std::abs(ranges_m[i] - finer_m[i]) <= vertex_m * slant + 0x1p-23 * ranges_m[i]);
  }
}

TEST_CASE("the parts of marvin can be cut: they keep their size") {
  const SceneFolder folder;
  const std::filesystem::path marvin = std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/marvin";
  write_finer_part(marvin / "cardboard_box.glb", folder.path() / "finer.glb", 4);
  std::size_t triangles = 0, finer = 0;
  scan_part(marvin, "cardboard_box.glb", triangles);
  scan_part(folder.path(), "finer.glb", finer);
  CHECK(finer == 16 * triangles);
}

}  // namespace simvis::bench
