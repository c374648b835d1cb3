// Compares rays through a heightmap as a regular grid with rays through a tree of boxes over the same triangles.
//
//   height_map [SIDE [REPETITIONS]]
//
// SIDE: pixels along a side of the map (default 4096). Prints CSV, a line for each scanner and kind: nanoseconds a ray
// (median, one thread, in turns), the first cast in ms, which makes the grid or the tree with two threads, bytes of
// either, and how many hits differ from those of the tree.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include <simvis/scan.h>
#include <glm/gtc/matrix_transform.hpp>
#include "bench/timing.h"
#include "engine/base/thread_pool.h"
#include "engine/raycast/blas.h"
#include "scenegraph/height_map.h"

namespace {

using namespace simvis;
using Clock = std::chrono::steady_clock;

constexpr const char* kKinds[] = {"grid", "tree"};

// Hills of five sizes, 1 m between pixels.
HeightMap hills(std::uint32_t side) {
  HeightPicture picture{side, side, std::vector<float>(std::size_t{side} * side)};
  for (std::uint32_t row = 0; row < side; ++row) {
    for (std::uint32_t column = 0; column < side; ++column) {
      double height = 0.5;
      for (int i = 0; i < 5; ++i) {
        const double wave = std::pow(3.7, i) * 0.004;
        height += 0.3 * std::pow(0.32, i) * std::sin(wave * column + i) * std::cos(0.8 * wave * row - i);
      }
      picture.values[std::size_t{row} * side + column] = static_cast<float>(height);
    }
  }
  return height_map(picture, glm::dvec2(side - 1), 0, 100);
}

DrawList list_of(const std::shared_ptr<const Mesh>& mesh, const glm::dmat4& place) {
  DrawList list;
  list.world_from_node = {place};
  list.materials = {std::make_shared<const Material>()};
  list.material_revision = {0};
  list.meshes = {mesh};
  list.items = {{.mesh = 0, .material = 0, .transform = 0}};
  return list;
}

std::vector<glm::dvec3> directions_of(int beams, int rings) {
  std::vector<glm::dvec3> directions;
  for (int ring = 0; ring < rings; ++ring) {
    const double e = rings == 1 ? -0.05 : -0.4 + 0.5 * ring / (rings - 1);
    for (int beam = 0; beam < beams; ++beam) directions.push_back(beam_direction(6.283 * beam / beams - 3.1415, e));
  }
  return directions;
}

std::size_t bytes_of(const DrawList& list) {
  const std::shared_ptr<const Blas> blas = shared_blas(list.meshes[0], {}, shared_thread_pool());
  if (blas->is_grid()) return blas->pyramid()->memory();
  return blas->tree().nodes().size() * sizeof(WideNode) + blas->leaves().size() * sizeof(WideBvh::Leaf);
}

struct Kind {
  DrawList list;
  double first_ms = 0;
  std::size_t bytes = 0;
  std::unique_ptr<RayCaster> first;  // keeps the grid or the tree
};

// Makes the grid or the tree.
Kind kind_of(Mesh mesh, const glm::dmat4& place) {
  Kind kind{.list = list_of(std::make_shared<const Mesh>(std::move(mesh)), place),
            .first = make_host_ray_caster({}, 2)};
  std::vector<RayHit> hit(1);
  const auto start = Clock::now();
  kind.first->set_world(kind.list);
  kind.first->cast(glm::translate(glm::dmat4(1), {1, 2, 200}), std::vector{glm::dvec3(0, 0, -1)}, hit);
  kind.first_ms = bench::since_ms(start);
  kind.bytes = bytes_of(kind.list);
  return kind;
}

void time_scanner(const Kind (&kinds)[2], int beams, int rings, int repetitions) {
  const std::vector<glm::dvec3> directions = directions_of(beams, rings);
  std::vector<RayHit> hits[2];
  std::vector<double> times_ns[2];
  const std::unique_ptr<RayCaster> casters[2] = {make_host_ray_caster({}, 1), make_host_ray_caster({}, 1)};
  std::size_t other = 0;
  for (int r = 0; r <= repetitions; ++r) {
    for (const int k : {r % 2, 1 - r % 2}) {
      hits[k].resize(directions.size());
      const auto start = Clock::now();
      casters[k]->set_world(kinds[k].list);
      casters[k]->cast(glm::translate(glm::dmat4(1), {0.3 * r, -0.2 * r, 70}), directions, hits[k]);
      if (r > 0) times_ns[k].push_back(1e6 * bench::since_ms(start) / static_cast<double>(directions.size()));
    }
    for (std::size_t i = 0; i < directions.size(); ++i) other += !(hits[0][i] == hits[1][i]);
  }
  const double of_tree_ns = bench::median(times_ns[1]);
  for (int k = 0; k < 2; ++k) {
    const double ns = bench::median(times_ns[k]);
    std::printf("%zu,%dx%d,%s,%.1f,%.3f,%.1f,%zu,%zu\n", kinds[k].list.meshes[0]->positions.size(), rings, beams,
                kKinds[k], ns, ns / of_tree_ns, kinds[k].first_ms, kinds[k].bytes, other);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto side = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 4096);
  const int repetitions = argc > 2 ? std::atoi(argv[2]) : 31;
  HeightMap map = hills(side);
  Mesh with_tree = map.mesh;
  with_tree.indices.insert(with_tree.indices.end(), {0, 0, 0});  // then it is no regular grid
  const Kind kinds[2] = {kind_of(std::move(map.mesh), map.place), kind_of(std::move(with_tree), map.place)};
  std::printf("heights,scanner,kind,ns_a_ray,ratio,first_ms,bytes,other_hits\n");
  time_scanner(kinds, 361, 1, repetitions);
  time_scanner(kinds, 1024, 64, repetitions);
  return 0;
}
