// each_allocation [MOST]: lets allocations of the library fail in a program that loads a scene, records it and makes
// frames: MOST of them (0: each), one at a time, spread over all. Each must be an exception, and the simulation after
// it must give the same numbers as the first. Ends with status 0 if so.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <simvis/image.h>
#include <simvis/scan.h>
#include <simvis/simulation.h>
#include "tests/preload/failing_allocations.h"

namespace {

constexpr const char* kScene = R"(<scene>
  <part shape="box" size="0.1 4 4" name="WALL" insert_at="ROOT" pose_offset="5 0 0 0 0 0"/>
  <element type="pose" name="MOVE" insert_at="WALL" x="0.5"/>
  <sensor type="camera" name="CAM" insert_at="ROOT" width="32" height="24" hfov="60" outputs="color depth"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5" min_angle="-60" max_angle="60" range_max="7"/>
  <sensor type="imu" name="IMU" insert_at="WALL"/>
</scene>)";

// All that one simulation does, and the numbers that it gives.
std::vector<double> simulate(const std::filesystem::path& recording) {
  simvis::Simulation simulation = simvis::Simulation::from_string(kScene);
  simulation.record({.file = recording});
  simulation.step();
  simulation.set("MOVE", "x", 1);
  simulation.step();
  simulation.finish_recording();
  const simvis::Scan& scan = simulation.scan("SCAN");
  std::vector<double> numbers(scan.range_m.begin(), scan.range_m.end());
  const simvis::Image& image = simulation.color("CAM");
  numbers.insert(numbers.end(), image.pixels.begin(), image.pixels.end());
  return numbers;
}

}  // namespace

int main(int argc, char** argv) {
  const long most = argc > 1 ? std::atol(argv[1]) : 0;
  // Each instance of lavapipe waits at its end for a thread of lowest priority, which writes this cache.
  ::setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  const std::filesystem::path recording =
      std::filesystem::temp_directory_path() / ("each_allocation_" + std::to_string(::getpid()) + ".mcap");
  const std::vector<double> expected = simulate(recording);
  simvis_fail_allocations(0, 0);
  simulate(recording);
  const long all = simvis_count_allocations().calls;
  const long step = most == 0 ? 1 : std::max(1L, all / most);
  std::mt19937 random(20261125);
  long failed = 0, thrown = 0, wrong = 0;
  for (long first = 1; first <= all; first += step) {
    const long at = first + std::uniform_int_distribution<long>(0, step - 1)(random);
    simvis_fail_allocations(at, 1);
    bool has_thrown = false;
    try {
      simulate(recording);
    } catch (const std::exception&) {
      has_thrown = true;
    }
    const long now = simvis_count_allocations().failed;
    simvis_fail_allocations(-1, 0);
    failed += now;
    thrown += has_thrown ? 1 : 0;
    if (has_thrown && now == 0) ++wrong;
    if (simulate(recording) == expected) continue;
    ++wrong;
    std::fprintf(stderr, "after allocation %ld failed, the next simulation gives other numbers\n", at);
  }
  std::filesystem::remove(recording);
  std::printf("of %ld allocations %ld failed, one in each simulation; %ld threw, %ld were done without; wrong: %ld\n",
              all, failed, thrown, failed - thrown, wrong);
  return wrong == 0 && failed > 0 ? 0 : 1;
}
