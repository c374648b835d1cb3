// Compares many simulations in one process with as many processes that have one simulation each.
//
//   many [SIMULATIONS [FRAMES [SENSORS]]]
//
// SIMULATIONS (100) simulations of marvin, each with its robot at a place of its own, are opened and make FRAMES (10)
// frames. SENSORS is `scanners` (three laser scanners, by ray casts) or `camera` (the robot's camera); without it both
// are measured. In one process the simulations are shared out to as many threads as the machine has cores; each
// simulation has one thread of its own either way.
//
// Prints CSV. `open_s` and `frames_s` are wall-clock times of all simulations together, from the file to the end of
// the first frame, and of the further frames; the columns with `cpu` are processor times of all processes and threads.
// `memory_mb` is the sum of the processes' proportional set sizes after the last frame: pages that processes share, as
// those of libraries, count once.
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "bench/timing.h"

namespace {

using namespace simvis;

struct Sensors {
  const char* name;
  const char* enabled;  ///< a type of sensors, or the name of a sensor
};
constexpr Sensors kSensors[] = {{"scanners", "laser_scanner"}, {"camera", "ROBOT_CAM"}};

/// A simulation with the robot at a place of its own on its drive.
class Robot {
 public:
  Robot(const Sensors& sensors, int number) : next_frame_(number) {
    const std::filesystem::path marvin = SIMVIS_SOURCE_DIR "/scenes/marvin";
    SimulationDesc desc;
    desc.threads = 1;
    desc.overrides = {{"laser_scanner", "method", "raycast", "METHOD"}};
    simulation_ = std::make_unique<Simulation>(Simulation::load(marvin / "marvin.xml", desc));
    drive_ = std::make_unique<Trajectory>(marvin / "drive.csv", simulation_->parameters());
    for (const SensorInfo& sensor : simulation_->sensors()) {
      simulation_->enable(sensor.name, sensor.type == sensors.enabled || sensor.name == sensors.enabled);
    }
  }

  void step() {
    constexpr double kFrame_s = 1.0 / 15;
    drive_->apply(kFrame_s * next_frame_++, simulation_->parameters());
    simulation_->step();
  }

 private:
  int next_frame_;
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<Trajectory> drive_;
};

/// Calls work(i) for each i below `count`, on as many threads as the machine has cores.
template <typename Work>
void share_out(std::size_t count, const Work& work) {
  const std::size_t threads = std::min<std::size_t>(count, std::max(1u, std::thread::hardware_concurrency()));
  std::vector<std::jthread> running;
  for (std::size_t first = 0; first < threads; ++first) {
    running.emplace_back([&, first] {
      for (std::size_t i = first; i < count; i += threads) work(i);
    });
  }
}

double processor_s() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double proportional_mb(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/smaps_rollup");
  for (std::string word; file >> word;) {
    double kib = 0;
    if (word == "Pss:" && file >> kib) return kib * 1024 / 1e6;
  }
  std::fprintf(stderr, "many: the kernel does not give the proportional set size of a process\n");
  std::exit(1);
}

struct Setup {
  Sensors sensors;
  std::size_t processes = 1, simulations = 1;  ///< per process
  int frames = 1;
};

/// A process that opens its simulations, and makes their frames on request.
class Group {
 public:
  Group(const Setup& setup, std::size_t number) {
    int orders[2], answers[2];
    if (pipe(orders) != 0 || pipe(answers) != 0) std::exit(1);
    std::fflush(stdout);
    process_ = fork();
    if (process_ != 0) {
      close(orders[0]);
      close(answers[1]);
      to_ = orders[1];
      from_ = answers[0];
      return;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    to_ = answers[1];
    from_ = orders[0];
    try {
      work(setup, number);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "many: %s\n", error.what());
      _exit(1);
    }
    _exit(0);
  }
  ~Group() {
    order();
    close(to_);
    close(from_);
    int status = 0;
    waitpid(process_, &status, 0);
  }
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;

  void order() const { send(0); }

  /// Waits until the process has done what it does, and returns the processor time that it took.
  double wait_s() const {
    double processor = 0;
    if (read(from_, &processor, sizeof processor) != sizeof processor) std::exit(1);
    return processor;
  }

  double memory_mb() const { return proportional_mb(process_); }

 private:
  void send(double number) const {
    if (write(to_, &number, sizeof number) != sizeof number) std::exit(1);
  }

  void work(const Setup& setup, std::size_t number) const {
    std::vector<std::unique_ptr<Robot>> robots(setup.simulations);
    wait_s();
    share_out(robots.size(), [&](std::size_t i) {
      robots[i] = std::make_unique<Robot>(setup.sensors, static_cast<int>(number * setup.simulations + i));
      robots[i]->step();
    });
    const double opened = processor_s();
    send(opened);
    wait_s();
    share_out(robots.size(), [&](std::size_t i) {
      for (int frame = 0; frame < setup.frames; ++frame) robots[i]->step();
    });
    send(processor_s() - opened);
    wait_s();
  }

  pid_t process_ = 0;
  int to_ = -1, from_ = -1;
};

struct Cost {
  double wall_s = 0, cpu_s = 0;
};

Cost together(const std::vector<std::unique_ptr<Group>>& groups) {
  const auto start = std::chrono::steady_clock::now();
  for (const auto& group : groups) group->order();
  Cost cost;
  for (const auto& group : groups) cost.cpu_s += group->wait_s();
  cost.wall_s = bench::since_ms(start) / 1e3;
  return cost;
}

void measure(const Setup& setup, bool print) {
  std::vector<std::unique_ptr<Group>> groups;
  for (std::size_t i = 0; i < setup.processes; ++i) groups.push_back(std::make_unique<Group>(setup, i));
  const Cost open = together(groups), frames = together(groups);
  double memory_mb = 0;
  for (const auto& group : groups) memory_mb += group->memory_mb();
  if (!print) return;
  std::printf("%s,%zu,%zu,%.2f,%.2f,%d,%.2f,%.2f,%.1f,%.2f\n", setup.sensors.name, setup.processes, setup.simulations,
              open.wall_s, open.cpu_s, setup.frames, frames.wall_s, frames.cpu_s, memory_mb,
              memory_mb / static_cast<double>(setup.processes * setup.simulations));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t simulations = argc > 1 ? std::max(1ul, std::strtoul(argv[1], nullptr, 10)) : 100;
  const int frames = argc > 2 ? std::max(1, std::atoi(argv[2])) : 10;
  const std::string wanted = argc > 3 ? argv[3] : "";
  std::printf(
      "sensors,processes,simulations_each,open_s,open_cpu_s,frames,frames_s,frames_cpu_s,memory_mb,"
      "memory_mb_each\n");
  for (const Sensors& sensors : kSensors) {
    if (!wanted.empty() && wanted != sensors.name) continue;
    measure({.sensors = sensors}, false);  // fills the caches
    measure({.sensors = sensors, .processes = 1, .simulations = simulations, .frames = frames}, true);
    measure({.sensors = sensors, .processes = simulations, .simulations = 1, .frames = frames}, true);
  }
  return 0;
}
