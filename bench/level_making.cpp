// Measures how long it takes to make the coarser levels of the meshes of a scene, and to read them from the cache.
//
//   level_making [TRIANGLES | SCENE.xml]...
//
// Without arguments: labs of 100,000 and of a million triangles, and scenes/ravon. Prints CSV, a line for each scene:
// with an empty cache (cold) and again (warm). Processor time is of all threads, and may be compared on a busy machine.
// `error_N` is the median error of level N of a mesh, or of a tile of a large one, as a share of its longest side.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/scenes/lab.h"
#include "bench/scenes/scene_folder.h"
#include "engine/base/thread_pool.h"
#include "engine/geometry/mesh_tiles.h"

namespace {

using namespace simvis;

struct Times {
  double wall_s = 0, processor_s = 0;
};

constexpr std::size_t kShownLevels = 4;

struct Made {
  std::size_t levels = 0, triangles = 0;
  std::array<std::vector<double>, kShownLevels> error_shares;  // by level, then by mesh
  Times times;
};

double longest_side(const Mesh& mesh) {
  const glm::vec3 size = mesh.bounds_max - mesh.bounds_min;
  return std::max({size.x, size.y, size.z});
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

double seconds_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Made make(const DrawList& list, const std::filesystem::path& cache) {
  const std::shared_ptr<ThreadPool> pool = shared_thread_pool();
  Made made;
  const double wall_s = seconds_of(CLOCK_MONOTONIC), processor_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
  std::vector<std::vector<LevelledTile>> tiles(list.meshes.size());
  pool->parallel_for(tiles.size(), 1, [&](std::size_t, std::size_t first, std::size_t count) {
    for (std::size_t i = first; i < first + count; ++i)
      tiles[i] = make_levelled_tiles(list.meshes[i], cache, pool.get());
  });
  made.times = {seconds_of(CLOCK_MONOTONIC) - wall_s, seconds_of(CLOCK_PROCESS_CPUTIME_ID) - processor_s};
  for (const std::vector<LevelledTile>& of_mesh : tiles) {
    for (const LevelledTile& tile : of_mesh) {
      for (std::size_t k = 0; k < tile.levels.size(); ++k) {
        ++made.levels;
        made.triangles += tile.levels[k].mesh->indices.size() / 3;
        if (k < kShownLevels) made.error_shares[k].push_back(tile.levels[k].error_m / longest_side(*tile.mesh));
      }
    }
  }
  return made;
}

void print(const std::string& name, const std::filesystem::path& scene, const std::filesystem::path& folder) {
  const Simulation simulation = Simulation::load(scene);
  const DrawList& list = simulation.diagnostics().draw_list();
  std::size_t triangles = 0;
  for (const std::shared_ptr<const Mesh>& mesh : list.meshes) {
    if (mesh->topology == Topology::triangles) triangles += mesh->indices.size() / 3;
  }
  const std::filesystem::path cache = folder / "cache";
  const Made cold = make(list, cache), warm = make(list, cache);
  std::printf("%s,%zu,%zu,%zu,%zu,%.3f,%.3f,%.3f,%.3f", name.c_str(), list.meshes.size(), triangles, cold.levels,
              cold.triangles, cold.times.wall_s, cold.times.processor_s, warm.times.wall_s, warm.times.processor_s);
  for (const std::vector<double>& shares : cold.error_shares) std::printf(",%.6f", median(shares));
  std::printf("\n");
  std::fflush(stdout);
}

void print_lab(std::size_t triangles, const std::filesystem::path& folder) {
  print("lab " + std::to_string(triangles), bench::write_lab(folder, triangles), folder);
}

}  // namespace

int main(int argc, char** argv) {
  std::printf(
      "scene,meshes,triangles,levels,level_triangles,cold_wall_s,cold_processor_s,warm_wall_s,"
      "warm_processor_s,error_1,error_2,error_3,error_4\n");
  const bench::SceneFolder folder;
  if (argc == 1) {
    print_lab(100'000, folder.path());
    print_lab(1'000'000, folder.path());
    print("ravon", SIMVIS_SOURCE_DIR "/scenes/ravon/ravon.xml", folder.path());
  }
  for (int i = 1; i < argc; ++i) {
    const std::string what = argv[i];
    if (what.find_first_not_of("0123456789") == std::string::npos) {
      print_lab(std::stoul(what), folder.path());
    } else {
      print(std::filesystem::path(what).stem(), what, folder.path());
    }
  }
  return 0;
}
