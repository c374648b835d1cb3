// Compares scanners with a beam table with an even grid of as many beams over the same field of view, in scenes/marvin.
//
//   beam_patterns [SCENE.xml [FRAMES]]
//
// Prints CSV. The scanners of a row are measured in turns, each alone in its simulation, so that other load on the
// machine affects both alike: compare ratios. A frame is a whole step with one scanner that casts. Times are medians of
// wall-clock time, and of the processor time of all threads, which other load affects less.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include <simvis/simulation.h>

namespace {

using namespace simvis;
using Clock = std::chrono::steady_clock;

struct Pair {
  const char *name, *pattern, *grid;
};
constexpr Pair kPairs[] = {
    {"VLP-16", R"(pattern="device:velodyne_vlp16")",
     R"(samples="1800" min_angle="-180" max_angle="179.8" vertical_samples="16" vertical_min_angle="-15"
        vertical_max_angle="15")"},
    {"VLS-128", R"(pattern="device:velodyne_vls128")",
     R"(samples="1875" min_angle="-180" max_angle="179.808" vertical_samples="128" vertical_min_angle="-25"
        vertical_max_angle="15")"},
    {"OS1-128", R"(pattern="device:ouster_os1_128")",
     R"(samples="1024" min_angle="-180" max_angle="179.6484375" vertical_samples="128" vertical_min_angle="-21.82"
        vertical_max_angle="20.95")"},
    {"OS0-32", R"(pattern="device:ouster_os0_32")",
     R"(samples="1024" min_angle="-180" max_angle="179.6484375" vertical_samples="32" vertical_min_angle="-45.4"
        vertical_max_angle="43.88")"},
};
constexpr int kWarmUp = 3;

double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

Simulation with_scanner(const std::filesystem::path& scene, const std::string& beams) {
  Simulation simulation = Simulation::load(scene);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, false);
  simulation.execute(R"(<sensor type="laser_scanner" name="PATTERN" insert_at="ROBOT" pose_offset="0 0 1 0 0 0" )" +
                     beams + "/>");
  return simulation;
}

void compare(const std::filesystem::path& scene, const Pair& pair, int frames) {
  Simulation scanners[] = {with_scanner(scene, pair.grid), with_scanner(scene, pair.pattern)};
  std::vector<double> times_ms[2], processor_times_ms[2];
  for (int frame = 0; frame < kWarmUp + frames; ++frame) {
    for (int turn = 0; turn < 2; ++turn) {
      const int which = (frame + turn) % 2;
      const auto start = Clock::now();
      const double before_ms = processor_ms();
      scanners[which].step();
      const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
      if (frame < kWarmUp) continue;
      times_ms[which].push_back(ms);
      processor_times_ms[which].push_back(processor_ms() - before_ms);
    }
  }
  const Scan& scan = scanners[1].scan("PATTERN");
  const double grid_ms = median(times_ms[0]), pattern_ms = median(times_ms[1]);
  const double grid_cpu_ms = median(processor_times_ms[0]), pattern_cpu_ms = median(processor_times_ms[1]);
  std::printf("%s,%zu,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f\n", pair.name, scan.range_m.size(), grid_ms, pattern_ms,
              pattern_ms / grid_ms, grid_cpu_ms, pattern_cpu_ms, pattern_cpu_ms / grid_cpu_ms);
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path scene = argc > 1 ? argv[1] : SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml";
  const int frames = argc > 2 ? std::atoi(argv[2]) : 40;
  std::printf("device,beams,grid_ms,pattern_ms,ratio,grid_cpu_ms,pattern_cpu_ms,cpu_ratio\n");
  for (const Pair& pair : kPairs) compare(scene, pair, frames);
  return 0;
}
