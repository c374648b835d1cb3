// Measures the cost of messages: encoding against memcpy, and a frame of marvin with and without a recording.
//
//   recording [BLOCKS]
//
// Prints CSV. Encoding: medians of the time for a cloud of 64 x 2048 points and for an image of 1920 x 1080, each as a
// message that is there already, beside the copy of as many bytes, and of making the message from the measurement.
// Frames: medians of step() in milliseconds, in blocks without and with recording in turn; "cameras" are all sensors,
// "scanners" the laser scanners alone. `rate_hz` is how often frames are called for: 0: one after the other, 15: as at
// 15 Hz, the caller sleeping in between if there is time. `caller_ms` is the processor time of the simulation's own
// thread, `record_ms` the part of step() that hands the messages over. Of all steps together `total_ratio` also counts
// the wait at the end of a recording for what is not yet written. Processor time is of all threads, over whole frames.
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "bench/timing.h"
#include "exchange/messages/cdr.h"
#include "exchange/messages/from_image.h"
#include "exchange/messages/from_scan.h"

namespace {

using Clock = std::chrono::steady_clock;
using namespace simvis;
using namespace simvis::bench;

double processor_ms() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) / 1e6;
}

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

template <typename Work>
double median_ms(const Work& work) {
  constexpr int kTimes = 51;
  std::vector<double> times;
  for (int i = 0; i < kTimes; ++i) {
    const Clock::time_point start = Clock::now();
    work();
    times.push_back(ms_since(start));
  }
  return median(times);
}

Scan lidar_scan() {
  Scan scan(64, 2048);
  std::vector<double> azimuths_rad, elevations_rad;
  for (std::uint32_t i = 0; i < scan.beams; ++i) azimuths_rad.push_back(i * 0.003);
  for (std::uint32_t i = 0; i < scan.rings; ++i) elevations_rad.push_back(i * 0.006);
  scan.set_angles(std::move(azimuths_rad), std::move(elevations_rad));
  const auto [ranges_m, bounds_m] = scan.edit_ranges();
  std::ranges::fill(ranges_m, 5.0f);
  std::ranges::fill(bounds_m, 5.0f);
  return scan;
}

template <typename Make>
void print_encoding(const char* name, const Make& make) {
  const auto message = make();
  std::string bytes;
  const auto encode = [&] {
    bytes.clear();
    ros::encode(message, bytes);
  };
  encode();
  std::vector<char> copy(bytes.size());
  std::printf("%s,%zu,%.4f,%.4f,%.4f\n", name, bytes.size(), median_ms(encode),
              median_ms([&] { std::memcpy(copy.data(), bytes.data(), copy.size()); }),
              median_ms([&] { (void)make(); }));
}

struct Run {
  std::vector<Took> plain, recorded;
  std::vector<double> record_ms;
  double plain_processor_ms = 0, recorded_processor_ms = 0;
  std::vector<double> finish_ms;
  RecordReport report;
};

/// So many blocks of frames without recording, and as many with it, in turn.
Run run(bool cameras, double rate_hz, int blocks) {
  constexpr int kBlock = 15;
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "simvis_recording_bench.mcap";
  std::filesystem::remove(file);
  Run result;
  Simulation simulation = Simulation::load(SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml");
  for (const SensorInfo& sensor : simulation.sensors()) {
    simulation.enable(sensor.name, cameras || sensor.type == "laser_scanner");
  }
  const Trajectory trajectory(SIMVIS_SOURCE_DIR "/scenes/marvin/drive.csv", simulation.parameters());
  simulation.step();
  auto due = Clock::now();
  double processor_start_ms = processor_ms();
  for (int frame = 0; frame <= 2 * blocks * kBlock; ++frame) {
    const bool records = frame / kBlock % 2 == 1;
    if (frame % kBlock == 0 && records) {
      result.plain_processor_ms += processor_ms() - processor_start_ms;
      processor_start_ms = processor_ms();
      simulation.record({.file = file});
    }
    if (frame % kBlock == 0 && !records && frame > 0) {
      const Clock::time_point start = Clock::now();
      result.report = simulation.finish_recording();
      result.finish_ms.push_back(ms_since(start));
      due = Clock::now();
      result.recorded_processor_ms += processor_ms() - processor_start_ms;
      processor_start_ms = processor_ms();
    }
    trajectory.apply(static_cast<double>(simulation.next_frame().time_ns) / 1e9, simulation.parameters());
    (records ? result.recorded : result.plain).push_back(time_work([&] { simulation.step(); }));
    for (const StageTime& stage : simulation.diagnostics().stages()) {
      if (stage.name == "record") result.record_ms.push_back(static_cast<double>(stage.end_ns - stage.start_ns) / 1e6);
    }
    if (rate_hz <= 0) continue;
    due += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate_hz));
    std::this_thread::sleep_until(due);
  }
  std::filesystem::remove(file);
  return result;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

double wall_ms(const std::vector<Took>& all) {
  double total = 0;
  for (const Took& took : all) total += took.wall_ms;
  return total;
}

}  // namespace

int main(int argc, char** argv) {
  const int blocks = argc > 1 ? std::atoi(argv[1]) : 10;
  std::printf("message,bytes,encode_ms,memcpy_ms,make_ms\n");
  const Scan scan = lidar_scan();
  print_encoding("cloud 64 x 2048", [&] { return ros::point_cloud(scan, "TOP"); });
  const Image image{1920, 1080, 4, std::vector<float>(std::size_t{1920} * 1080 * 4, 0.4f)};
  print_encoding("image 1920 x 1080", [&] { return ros::to_image(image, {}, "rgb8"); });
  std::printf(
      "\nsensors,rate_hz,plain_ms,recorded_ms,ratio,caller_plain_ms,caller_recorded_ms,caller_ratio,record_ms,total_"
      "ratio,processor_ratio,"
      "finish_ms,file_bytes\n");
  for (const bool cameras : {false, true}) {
    for (const double rate_hz : {0.0, 15.0}) {
      const Run measured = run(cameras, rate_hz, blocks);
      const Took plain = median(measured.plain), recorded = median(measured.recorded);
      const double frames = static_cast<double>(measured.plain.size()) / static_cast<double>(measured.recorded.size());
      const double total = frames * (wall_ms(measured.recorded) + sum(measured.finish_ms)) / wall_ms(measured.plain);
      std::printf("%s,%g,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.1f,%llu\n", cameras ? "cameras" : "scanners",
                  rate_hz, plain.wall_ms, recorded.wall_ms, recorded.wall_ms / plain.wall_ms, plain.caller_ms,
                  recorded.caller_ms, recorded.caller_ms / plain.caller_ms, median(measured.record_ms), total,
                  measured.recorded_processor_ms / measured.plain_processor_ms, median(measured.finish_ms),
                  static_cast<unsigned long long>(measured.report.bytes));
      std::fflush(stdout);
    }
  }
}
