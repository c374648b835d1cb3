// Measures the time that a camera of 640 x 480 pixels takes for Gaussian splats: flat ones on the walls of a room, in
// whose middle the camera stands.
//
//   splats [REPETITIONS]
//
// Prints CSV, a line for each number and size of splats: seconds for a frame (median, all threads, and one thread), and
// the mean share of light that shines through.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "bench/timing.h"
#include "engine/base/thread_pool.h"
#include "engine/splats/splat_rays.h"

namespace {

using namespace simvis;

constexpr std::uint32_t kWidth_px = 640, kHeight_px = 480;

struct Case {
  std::size_t splats;
  double sigma_m;  // median of the longest axis
};
constexpr Case kCases[] = {{100'000, 0.02}, {300'000, 0.03}, {1'000'000, 0.02}, {1'000'000, 0.04}, {3'000'000, 0.015}};

class Numbers {
 public:
  double between(double low, double high) { return low + (high - low) * static_cast<double>(numbers_()) / 0x1p32; }
  glm::dvec3 vec(double low, double high) {
    const double x = between(low, high), y = between(low, high);
    return {x, y, between(low, high)};
  }

 private:
  std::mt19937 numbers_;
};

// On the walls of a room of 8 x 4 x 8 m around the camera.
SplatCloud walls(const Case& of) {
  Numbers numbers;
  SplatCloud cloud;
  cloud.degree = kMaxHarmonicsDegree;
  for (std::size_t i = 0; i < of.splats; ++i) {
    glm::dvec3 place = numbers.vec(-1, 1);
    const auto wall = static_cast<int>(i % 3);
    place[wall] = place[wall] > 0 ? 1 : -1;
    Splat splat;
    splat.center = glm::vec3(place * glm::dvec3(4, 2, 4) + numbers.vec(-0.05, 0.05));
    const double longest = of.sigma_m * std::exp(numbers.between(-1.2, 1.2));
    splat.sigma = glm::vec3(glm::dvec3(longest, longest * numbers.between(0.1, 1), longest * 0.05));
    const glm::dvec3 axis = numbers.vec(-1, 1);
    splat.rotation = glm::vec4(glm::normalize(glm::dvec4(axis, numbers.between(-1, 1))));
    splat.opacity = static_cast<float>(numbers.between(0, 1));
    cloud.splats.push_back(splat);
    for (std::uint32_t c = 0; c < harmonics_count(cloud.degree); ++c) {
      cloud.harmonics.push_back(glm::vec3(numbers.vec(-0.3, 0.3)));
    }
  }
  return cloud;
}

DrawList list_of(const SplatCloud& cloud) {
  Mesh mesh;
  mesh.splats = std::make_shared<const SplatCloud>(cloud);
  DrawList list;
  list.world_from_node = {glm::dmat4(1)};
  list.materials = {std::make_shared<const Material>()};
  list.material_revision = {0};
  list.meshes = {std::make_shared<const Mesh>(mesh)};
  list.items = {{.mesh = 0, .material = 0, .transform = 0}};
  return list;
}

std::vector<glm::dvec3> rays() {
  constexpr double kFocal_px = 554.256;  // 60 degrees
  std::vector<glm::dvec3> directions;
  for (std::uint32_t y = 0; y < kHeight_px; ++y) {
    for (std::uint32_t x = 0; x < kWidth_px; ++x) {
      directions.push_back(glm::normalize(
          glm::dvec3((x + 0.5 - kWidth_px / 2.0) / kFocal_px, (y + 0.5 - kHeight_px / 2.0) / kFocal_px, 1)));
    }
  }
  return directions;
}

}  // namespace

int main(int count, char** arguments) {
  const int repetitions = count > 1 ? std::atoi(arguments[1]) : 3;
  const std::vector<glm::dvec3> directions = rays();
  const std::vector<double> near_m(directions.size(), 0.05),
      end_m(directions.size(), std::numeric_limits<double>::infinity());
  std::vector<SplatSight> sights(directions.size());
  std::printf("splats,sigma_m,threads,frame_s,transmittance\n");
  for (const Case& of : kCases) {
    const DrawList list = list_of(walls(of));
    for (const unsigned threads : {0u, 1u}) {
      const std::shared_ptr<ThreadPool> pool = shared_thread_pool(threads);
      std::vector<double> seconds;
      for (int i = 0; i < repetitions; ++i) {
        const bench::Took took = bench::time_work([&] {
          see_through(see_splats(list, glm::dmat4(1), {}),
                      {.width_px = kWidth_px, .directions = directions, .near_m = near_m, .end_m = end_m}, *pool,
                      sights);
        });
        seconds.push_back(took.wall_ms / 1e3);
      }
      double transmittance = 0;
      for (const SplatSight& sight : sights) transmittance += sight.transmittance / static_cast<double>(sights.size());
      std::printf("%zu,%g,%u,%.3f,%.3f\n", of.splats, of.sigma_m, pool->size(), bench::quantile(seconds, 0.5),
                  transmittance);
    }
  }
}
