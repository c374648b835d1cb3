// Two measurements: the time that a follower adds to the frames of its host, and the time that it needs to catch up.
#include <time.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "bench/serving/parts.h"
#include "bench/timing.h"

namespace simvis::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kBlock = 30, kOpenings = 7;
constexpr auto kPeriod = std::chrono::microseconds(66'667);  // 15 Hz, the rate of marvin's scanners
constexpr int kPatience_ms = 120'000;
const std::string kMarvin = SIMVIS_SOURCE_DIR "/scenes/marvin/";

double process_ms() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// A folder of its own that goes at the end.
struct Folder {
  Folder() : path(std::filesystem::temp_directory_path() / own_name("serving")) {
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::filesystem::path path;
};

/// Follows the host, is killed after a random time, and comes again.
class Visitor {
 public:
  Visitor(const std::string& name, const Folder& folder)
      : command_{SIMVIS_RUN, "--follow", name, "--quiet", "--out", folder.path / "out", kMarvin + "view.xml"} {}
  ~Visitor() { leave(); }
  void visit() {
    if (pid_ == 0) {
      pid_ = start_program(command_);
      end_ = Clock::now() + std::chrono::milliseconds(random_() % 6000);
      ++starts;
    } else if (Clock::now() > end_) {
      leave();
    }
  }
  void leave() {
    if (pid_ != 0) kill_hard(pid_);
    pid_ = 0;
  }
  int starts = 0;

 private:
  std::vector<std::string> command_;
  std::mt19937 random_{1};
  Clock::time_point end_;
  pid_t pid_ = 0;
};

struct Times {
  std::vector<double> wall_ms, thread_ms, process_ms;
};

/// A simulation of marvin's scanners on its drive, without what shows them.
Simulation marvin() {
  Simulation simulation = Simulation::load(kMarvin + "marvin.xml");
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.type == "laser_scanner");
  return simulation;
}

std::size_t different_bytes(const Simulation& a, const Simulation& b) {
  std::size_t different = 0;
  for (const std::string& name : a.measured()) {
    const Scan &one = a.scan(name), &other = b.scan(name);
    const std::size_t bytes = one.range_m.size() * sizeof one.range_m[0];
    different += one.range_m.size() != other.range_m.size() ||
                 std::memcmp(one.range_m.data(), other.range_m.data(), bytes) != 0 ||
                 std::memcmp(one.error_bound_m.data(), other.error_bound_m.data(), bytes) != 0;
  }
  return different;
}

void print_times(const char* what, const std::vector<double>& without, const std::vector<double>& with) {
  std::printf("%s,%.3f,%.3f,%.3f\n", what, median(without), median(with), median(with) / median(without));
}

/// A plate for every 100 parts, and a scanner between them.
std::filesystem::path write_scene(const std::filesystem::path& folder, int parts) {
  constexpr int kPartsOfFile = 100;
  std::ofstream scene(folder / "scene.xml");
  scene << "<simvis>\n";
  for (int i = 0; i < parts; ++i) {
    const std::string plate = "plate" + std::to_string(i / kPartsOfFile) + ".obj";
    if (i % kPartsOfFile == 0) {
      std::ofstream(folder / plate) << "v 0 -0.2 -1\nv 0 0.2 -1\nv 0 0.2 1\nv 0 -0.2 " << 1 + i << "e-6\n"
                                    << "f 1 2 3\nf 1 3 4\n";
    }
    scene << "<part file='" << plate << "' name='P" << i << "' insert_at='ROOT' pose_offset='" << i % 100 << " "
          << i / 100 << " 0 0 0 0'/>\n";
  }
  scene << "<element type='pose' name='MOVE' insert_at='ROOT'/>\n"
        << "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT'/>\n</simvis>\n";
  return folder / "scene.xml";
}

/// Time from `start` until the file is there: run.json appears with the first frame.
double seconds_until(Clock::time_point start, const std::filesystem::path& file) {
  while (!std::filesystem::exists(file)) {
    if (since_ms(start) > kPatience_ms) throw std::runtime_error(file.string() + " does not appear");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return since_ms(start) / 1e3;
}

}  // namespace

void measure_follower(int blocks) {
  const Folder folder;
  const std::string name = own_name("followed");
  Simulation host = marvin(), alone = marvin();
  host.serve({.name = name});
  const Trajectory trajectory(kMarvin + "drive.csv", host.parameters());
  Visitor visitor(name, folder);
  Times without, with;
  std::size_t different = 0, scans = 0;
  auto due = Clock::now();
  for (int frame = 0; frame < 2 * blocks * kBlock; ++frame) {
    const bool followed = frame / kBlock % 2 == 1;
    if (followed) visitor.visit();
    if (!followed) visitor.leave();
    for (Simulation* const each : {&host, &alone}) {
      trajectory.apply(static_cast<double>(each->next_frame().time_ns) / 1e9, each->parameters());
    }
    const double process_start_ms = process_ms();
    const Took took = time_work([&] { host.step(); });
    Times& times = followed ? with : without;
    times.wall_ms.push_back(took.wall_ms);
    times.thread_ms.push_back(took.caller_ms);
    times.process_ms.push_back(process_ms() - process_start_ms);
    alone.step();
    different += different_bytes(host, alone);
    scans += host.measured().size();
    due += kPeriod;
    std::this_thread::sleep_until(due);
  }
  visitor.leave();
  std::printf("time of a frame,without_ms,with_ms,ratio\n");
  print_times("wall clock", without.wall_ms, with.wall_ms);
  print_times("processor time of the host's thread", without.thread_ms, with.thread_ms);
  print_times("processor time of the host's process", without.process_ms, with.process_ms);
  std::printf("\nfollowers started and killed,scans compared,scans that differ\n%d,%zu,%zu\n", visitor.starts, scans,
              different);
  std::fflush(stdout);
}

void measure_opening(int parts) {
  const Folder folder;
  const std::filesystem::path scene = write_scene(folder.path, parts);
  std::printf("parts,host_opens_s,follower_catches_up_s,ratio\n");
  std::vector<double> opens, catches;
  for (int i = 0; i < kOpenings; ++i) {
    const std::string name = own_name("opening" + std::to_string(i));
    const auto run = [&](const char* option, const std::string& out, const std::vector<std::string>& more) {
      std::vector<std::string> command{SIMVIS_RUN, "--quiet", option, name, "--out", folder.path / out};
      command.insert(command.end(), more.begin(), more.end());
      const auto start = Clock::now();
      const pid_t program = start_program(command);
      return std::pair(program, seconds_until(start, folder.path / out / "run.json"));
    };
    const std::string number = std::to_string(i);
    const auto [host, host_s] = run("--serve", "host" + number, {"--real-time", "1", scene});
    const auto [follower, follower_s] = run("--follow", "follower" + number, {});
    opens.push_back(host_s);
    catches.push_back(follower_s);
    kill_hard(follower);
    ::kill(host, SIGTERM);  // so that it removes its shared memory
    wait_for(host);
  }
  std::printf("%d,%.2f,%.2f,%.2f\n", parts, median(opens), median(catches), median(catches) / median(opens));
  std::fflush(stdout);
}

}  // namespace simvis::bench
