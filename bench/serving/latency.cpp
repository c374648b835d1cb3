// From a client's write to its effect in a scan.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include <simvis/simulation.h>
#include <simvis_client/connection.h>
#include "bench/serving/parts.h"
#include "bench/timing.h"

namespace simvis::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPatience_ms = 60'000;

struct Case {
  const char* name;
  const char* scene;  // a file below the source folder, or empty: kBox
  const char* element;
  const char* scanner;
};
constexpr Case kCases[] = {{"one scanner before a box", "", "MOVE", "SCAN"},
                           {"scanners of marvin", "/scenes/marvin/marvin.xml", "R_POSE", "FRONT_SCANNER"}};
constexpr const char* kBox = R"(
  <part shape="box" size="1 20 20" name="BOX" insert_at="ROOT" pose_offset="8 0 0 0 0 0"/>
  <element type="pose" name="MOVE" insert_at="ROOT"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="361" min_angle="-90" max_angle="90"/>)";

// Nothing else moves, so the first scan with other ranges is the first one that was made with the written value.
void write_and_watch(const std::string& name, const Case& each, int writes, int pipe) {
  client::Connection host(name, "writer", kPatience_ms);
  if (!host.wait_frame(2, kPatience_ms)) throw std::runtime_error("no frame");
  const std::int64_t x = host.parameter(each.element, "x"), scanner = host.sensor(each.scanner);
  const double start = host.value(x);
  const auto ranges = [&] {
    for (;;) {
      const std::optional<client::Measurement> scan = host.latest(scanner);
      const std::span<const float> shared = scan->output<float>("range_m");
      std::vector<float> copy(shared.begin(), shared.end());
      if (scan->whole()) return copy;
    }
  };
  std::mt19937 random(1);
  for (int i = 0; i < writes; ++i) {
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
    const std::vector<float> before = ranges();
    const auto written = Clock::now();
    host.set(x, start + 0.001 * (i % 2 + 1));
    std::uint64_t seen = 0;
    do {
      seen = simvis_frame(host.get());
      if (ranges() != before) break;
    } while (host.wait_frame(seen, kPatience_ms));
    const double took_ms = since_ms(written);
    if (::write(pipe, &took_ms, sizeof took_ms) != sizeof took_ms) throw std::runtime_error("pipe");
  }
}

void run(const Case& each, int writes) {
  const std::string name = own_name("latency");
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("pipe");
  const pid_t client = in_child([&] { write_and_watch(name, each, writes, ends[1]); });
  ::close(ends[1]);
  std::vector<double> frame_ms;
  {
    Simulation simulation = *each.scene == 0 ? Simulation::from_string(kBox)
                                             : Simulation::load(std::string(SIMVIS_SOURCE_DIR) + each.scene);
    for (const SensorInfo& sensor : simulation.sensors()) {
      simulation.enable(sensor.name, sensor.type == "laser_scanner");
    }
    simulation.serve({.name = name});
    int status = 0;
    while (::waitpid(client, &status, WNOHANG) == 0) {
      const auto start = Clock::now();
      simulation.step();
      frame_ms.push_back(since_ms(start));
    }
  }
  std::vector<double> latency_ms(static_cast<std::size_t>(writes));
  std::size_t read = 0;
  while (read < latency_ms.size() && ::read(ends[0], &latency_ms[read], sizeof(double)) == sizeof(double)) ++read;
  ::close(ends[0]);
  if (read != latency_ms.size()) throw std::runtime_error("the client has not finished");
  std::printf("%s,%d,%.3f,%.3f,%.3f,%.3f,%.3f\n", each.name, writes, median(frame_ms), median(latency_ms),
              quantile(latency_ms, 0.9), quantile(latency_ms, 0.99), quantile(latency_ms, 1));
  constexpr double kFirst_ms = 0.25;
  constexpr int kBuckets = 20;
  std::vector<int> histogram(kBuckets);
  for (const double ms : latency_ms) {
    const int bucket = static_cast<int>(std::ceil(2 * std::log2(ms / kFirst_ms)));
    ++histogram[static_cast<std::size_t>(std::min(std::max(bucket, 0), kBuckets - 1))];
  }
  for (int i = 0; i < kBuckets; ++i) {
    if (histogram[static_cast<std::size_t>(i)] > 0) {
      std::printf("%s up to %.2f ms,%d\n", each.name, kFirst_ms * std::exp2(0.5 * i),
                  histogram[static_cast<std::size_t>(i)]);
    }
  }
  std::fflush(stdout);
}

}  // namespace

void measure_latency(int writes) {
  std::printf("scene,writes,frame_ms,median_ms,p90_ms,p99_ms,max_ms\n");
  for (const Case& each : kCases) run(each, writes);
}

}  // namespace simvis::bench
