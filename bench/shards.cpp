// Compares a run by several processes on this machine (simvis-run --shard K/N) with one process that computes all
// frames: marvin with its three scanners and a camera, including files.
//
//   shards [FRAMES [ROUNDS]]
//
// Prints one CSV line for each number of processes: medians over the rounds, which take turns. `speed_up` is relative
// to one process; `cpu_share` is the processor time of all processes divided by that of one process. If one process
// already uses all cores, N processes gain the time that these are idle, and pay for N starts.
#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <vector>

extern char** environ;

namespace {

struct Cost {
  double wall_s = 0, cpu_s = 0;
};

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

pid_t start(std::vector<std::string> arguments) {
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawn(&child, pointers[0], nullptr, nullptr, pointers.data(), environ) != 0) std::exit(1);
  return child;
}

Cost run(int processes, const std::string& frames, const std::filesystem::path& out) {
  const std::filesystem::path scene = SIMVIS_SOURCE_DIR "/scenes/marvin";
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < processes; ++k) {
    start({SIMVIS_RUN, scene / "marvin.xml", "--trajectory", scene / "drive.csv", "--frames", frames, "--out", out,
           "--quiet", "--sensor", "FRONT_SCANNER", "--sensor", "REAR_SCANNER", "--sensor", "TILT_SCANNER", "--sensor",
           "ROBOT_CAM", "--shard", std::to_string(k) + "/" + std::to_string(processes)});
  }
  Cost cost;
  for (int k = 0; k < processes; ++k) {
    int status = 0;
    rusage usage{};
    if (wait4(-1, &status, 0, &usage) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) std::exit(1);
    cost.cpu_s += seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  cost.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::filesystem::remove_all(out);
  return cost;
}

double median(std::vector<Cost> costs, double Cost::*part) {
  std::ranges::sort(costs, {}, part);
  return costs[costs.size() / 2].*part;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string frames = argc > 1 ? argv[1] : "120";
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 5;
  const std::filesystem::path out =
      std::filesystem::temp_directory_path() / ("simvis_shards_" + std::to_string(::getpid()));
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<int> numbers{1, 2, 4};
  if (cores > 4) numbers.push_back(cores);
  run(1, "1", out);  // fills the caches
  std::map<int, std::vector<Cost>> costs;
  for (int round = 0; round < rounds; ++round) {
    for (const int processes : numbers) costs[processes].push_back(run(processes, frames, out));
  }
  std::printf("cores,processes,frames,wall_s,cpu_s,frames_per_s,speed_up,cpu_share\n");
  for (const int processes : numbers) {
    const double wall_s = median(costs[processes], &Cost::wall_s), cpu_s = median(costs[processes], &Cost::cpu_s);
    std::printf("%d,%d,%s,%.3f,%.3f,%.1f,%.2f,%.2f\n", cores, processes, frames.c_str(), wall_s, cpu_s,
                std::atof(frames.c_str()) / wall_s, median(costs[1], &Cost::wall_s) / wall_s,
                cpu_s / median(costs[1], &Cost::cpu_s));
  }
  return 0;
}
