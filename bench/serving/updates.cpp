// 1,000 parameters that four processes write a thousand times per second.
#include <array>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <thread>
#include <vector>

#include <simvis_client/connection.h>
#include "bench/serving/parts.h"
#include "bench/timing.h"
#include "exchange/clients/host.h"

namespace simvis::bench {
namespace {

using Clock = std::chrono::steady_clock;

// 41 elements of 6 values, each written as a whole, and 4 single values make 250 parameters of each process.
constexpr int kProcesses = 4, kPoses = 41, kSingles = 4, kPoseValues = 6;
constexpr auto kPeriod = std::chrono::milliseconds(1);
constexpr int kPatience_ms = 60'000;

struct Counts {
  std::uint64_t ticks = 0, late = 0;  // a tick is late when the next one is due before it has begun
};

void add_elements(SharedHost& host) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<SharedParameter> pose;
  for (const char* name : {"x", "y", "z", "roll", "pitch", "yaw"}) pose.push_back({name, "", -kInfinity, kInfinity});
  const SharedParameter single{"value", "", -kInfinity, kInfinity};
  for (int process = 0; process < kProcesses; ++process) {
    for (int i = 0; i < kPoses; ++i) host.add_element("P", "pose", "ROOT", pose);
    for (int i = 0; i < kSingles; ++i) host.add_element("S", "joint", "ROOT", {&single, 1});
  }
}

std::int64_t first_element(int process) { return static_cast<std::int64_t>(process) * (kPoses + kSingles); }
std::int64_t first_single(int process) {
  return static_cast<std::int64_t>(process) * (kPoses * kPoseValues + kSingles) + kPoses * kPoseValues;
}

// All values that it writes in a tick are the number of the tick. It stays until the host has taken the last ones.
void write_values(const std::string& name, int process, std::uint64_t ticks, int pipe) {
  client::Connection host(name, "writer" + std::to_string(process), kPatience_ms);
  host.wait_frame(0, kPatience_ms);
  Counts counts;
  auto due = Clock::now();
  for (counts.ticks = 1; counts.ticks <= ticks; ++counts.ticks) {
    std::array<double, kPoseValues> pose;
    pose.fill(static_cast<double>(counts.ticks));
    for (int i = 0; i < kPoses; ++i) host.set_element(first_element(process) + i, pose);
    for (int i = 0; i < kSingles; ++i) host.set(first_single(process) + i, pose[0]);
    due += kPeriod;
    counts.late += Clock::now() > due;
    std::this_thread::sleep_until(due);
  }
  --counts.ticks;
  if (::write(pipe, &counts, sizeof counts) != sizeof counts) throw std::runtime_error("pipe");
  host.wait_frame(UINT64_MAX - 1, -1);  // until the host ends
}

struct Seen {
  std::uint64_t poses = 0, torn = 0, backwards = 0;
  std::vector<double> elements = std::vector<double>(kProcesses * (kPoses + kSingles));
  std::vector<double> singles = std::vector<double>(kProcesses * (kPoses * kPoseValues + kSingles));
};

void take(SharedHost& host, Seen& seen) {
  const ClientInputs inputs = host.take();
  for (const WrittenElement& written : inputs.elements) {
    ++seen.poses;
    double& last = seen.elements[written.element];
    for (const double value : written.values) seen.torn += value != written.values.front();
    seen.backwards += written.values.front() <= last;
    last = written.values.front();
  }
  for (const WrittenValue& written : inputs.values) {
    seen.backwards += written.value <= seen.singles[written.parameter];
    seen.singles[written.parameter] = written.value;
    host.set_value(written.parameter, written.value);
  }
}

std::size_t lost_values(const Seen& seen, const std::vector<Counts>& counts) {
  std::size_t lost = 0;
  for (int process = 0; process < kProcesses; ++process) {
    const auto last = static_cast<double>(counts[static_cast<std::size_t>(process)].ticks);
    for (int i = 0; i < kPoses; ++i) {
      lost += kPoseValues * (seen.elements[static_cast<std::size_t>(first_element(process) + i)] != last);
    }
    for (int i = 0; i < kSingles; ++i) {
      lost += seen.singles[static_cast<std::size_t>(first_single(process) + i)] != last;
    }
  }
  return lost;
}

}  // namespace

void measure_updates(std::size_t checks) {
  const std::uint64_t ticks = (checks + kProcesses * kPoses - 1) / (kProcesses * kPoses);
  const std::string name = own_name("updates");
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("pipe");
  std::vector<pid_t> writers;
  for (int i = 0; i < kProcesses; ++i) {
    writers.push_back(in_child([&] { write_values(name, i, ticks, ends[1]); }));
  }
  ::close(ends[1]);
  Seen seen;
  std::vector<Counts> counts(kProcesses);
  std::vector<double> take_ms;
  double run_s = 0;
  {
    SharedHost host(name);
    host.publish();
    add_elements(host);
    for (int i = 0; i < kProcesses; ++i) {
      while (!host.is_connected("writer" + std::to_string(i))) std::this_thread::yield();
    }
    host.finish_frame(1, 0);
    const auto start = Clock::now();
    std::atomic<int> finished = 0;
    std::thread reader([&] {
      for (Counts& each : counts) {
        finished += ::read(ends[0], &each, sizeof each) == static_cast<ssize_t>(sizeof each) ? 1 : kProcesses;
      }
    });
    while (finished < kProcesses) {
      const auto take_start = Clock::now();
      take(host, seen);
      take_ms.push_back(since_ms(take_start));
      std::this_thread::sleep_for(kPeriod / 4);
    }
    run_s = since_ms(start) / 1e3;
    reader.join();
    take(host, seen);
  }
  for (const pid_t writer : writers) wait_for(writer);
  ::close(ends[0]);
  std::uint64_t late = 0;
  for (const Counts& each : counts) late += each.late;
  const double parameters = kProcesses * (kPoses * kPoseValues + kSingles);
  std::printf(
      "parameters,processes,seconds,updates_written,poses_checked,torn,backwards,values_lost,late_ticks,take_ms\n");
  std::printf("%.0f,%d,%.1f,%.0f,%llu,%llu,%llu,%zu,%llu,%.4f\n", parameters, kProcesses, run_s,
              parameters * static_cast<double>(ticks), static_cast<unsigned long long>(seen.poses),
              static_cast<unsigned long long>(seen.torn), static_cast<unsigned long long>(seen.backwards),
              lost_values(seen, counts), static_cast<unsigned long long>(late), median(take_ms));
  std::fflush(stdout);
}

}  // namespace simvis::bench
