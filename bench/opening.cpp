// Measures the time and the memory to open a large scene: a generated world of 10^4 to 10^7 triangles (bumpy ground and
// balls, one glTF file), each in its own process from the start until the first frame is in the caller's memory, with
// an empty cache folder and with a filled one. Host memory is the peak of the process; it includes the memory of a CPU
// device.
//
//   opening [MOST_TRIANGLES [REPEATS]]
//
// Prints one CSV line per number of triangles and sensor: camera (colour and depth), planar and raycast scanner.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <simvis/simulation.h>
#include "bench/big_world.h"

namespace {

using simvis::FrameCounters;
using simvis::Simulation;

struct Opening {
  double wall_s = 0, cpu_s = 0;
  std::uint64_t content_bytes = 0, device_bytes = 0, peak_bytes = 0;
};

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

// Opens the scene in a child process. Exits if that fails.
Opening open_once(const std::string& xml, const std::filesystem::path& folder) {
  int ends[2];
  if (pipe(ends) != 0) std::exit(1);
  const auto start = std::chrono::steady_clock::now();
  const pid_t child = fork();
  if (child == 0) {
    simvis::SimulationDesc desc;
    desc.device.cache_dir = (folder / "cache").string();
    {
      Simulation simulation = Simulation::from_string(xml, desc, folder);
      simulation.step();
      const FrameCounters& counters = simulation.diagnostics().counters();
      const std::uint64_t bytes[] = {counters.mesh_bytes + counters.texture_bytes,
                                     simulation.diagnostics().device_memory_bytes()};
      if (write(ends[1], bytes, sizeof bytes) != sizeof bytes) _exit(1);
    }
    _exit(0);
  }
  close(ends[1]);
  std::uint64_t bytes[2] = {};
  const bool is_read = read(ends[0], bytes, sizeof bytes) == sizeof bytes;
  Opening opening;
  opening.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  close(ends[0]);
  int status = 0;
  rusage used{};
  wait4(child, &status, 0, &used);
  if (!is_read || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::fprintf(stderr, "opening: the scene cannot be opened\n");
    std::exit(1);
  }
  opening.cpu_s = seconds(used.ru_utime) + seconds(used.ru_stime);
  opening.content_bytes = bytes[0];
  opening.device_bytes = bytes[1];
  opening.peak_bytes = static_cast<std::uint64_t>(used.ru_maxrss) * 1024;
  return opening;
}

Opening median(std::vector<Opening> openings) {
  std::ranges::sort(openings, {}, &Opening::wall_s);
  return openings[openings.size() / 2];
}

struct Case {
  const char* name;
  const char* sensor;
};
constexpr Case kCases[] = {
    {"camera", R"(<sensor type="camera" name="S" insert_at="ROOT" pose_offset="0 0 6 0 20 0" outputs="color depth"/>)"},
    {"planar", R"(<sensor type="laser_scanner" name="S" insert_at="ROOT" pose_offset="0 0 2 0 0 0" method="planar"/>)"},
    {"raycast",
     R"(<sensor type="laser_scanner" name="S" insert_at="ROOT" pose_offset="0 0 2 0 0 0" method="raycast"/>)"}};

void measure(std::uint64_t wanted, int repeats, const std::filesystem::path& folder) {
  const std::uint64_t triangles = simvis::bench::write_big_world(folder / "world.glb", wanted);
  for (const Case& each : kCases) {
    const std::string xml =
        std::string(R"(<part file="world.glb" name="WORLD" insert_at="ROOT" up="z"/>)") + each.sensor;
    std::vector<Opening> cold, warm;
    for (int i = 0; i < repeats; ++i) {
      std::filesystem::remove_all(folder / "cache");
      cold.push_back(open_once(xml, folder));
      warm.push_back(open_once(xml, folder));
    }
    const Opening first = median(cold), later = median(warm);
    const auto megabytes = [](std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; };
    std::printf("%llu,%s,%.3f,%.3f,%.3f,%.3f,%.1f,%.1f,%.1f\n", static_cast<unsigned long long>(triangles), each.name,
                first.wall_s, first.cpu_s, later.wall_s, later.cpu_s, megabytes(later.content_bytes),
                megabytes(later.device_bytes), megabytes(later.peak_bytes));
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t most = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10'000'000;
  const int repeats = argc > 2 ? std::max(1, std::atoi(argv[2])) : 3;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("simvis_opening_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::printf("triangles,sensor,first_s,first_cpu_s,later_s,later_cpu_s,content_mb,device_mb,host_peak_mb\n");
  for (std::uint64_t triangles = 10'000; triangles <= most; triangles *= 10) measure(triangles, repeats, folder);
  std::filesystem::remove_all(folder);
  return 0;
}
