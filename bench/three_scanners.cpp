// Measures the figure of the paper: sets of three scans of 361 values per second, on scenes/marvin with the moving
// robot, compared with the 15 Hz of its scanners.
//
//   three_scanners [SCENE.xml [FRAMES [METHOD]]]
//
// All scanners measure by METHOD; the default is planar, the paper's method with depth images. Prints one CSV line per
// run: its name, sets per second, milliseconds and megabytes. A set is a whole frame: parameters, flattening, planning,
// rendering, and results in the caller's memory, without files.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>

int main(int argc, char** argv) {
  using namespace simvis;
  using Clock = std::chrono::steady_clock;
  constexpr double kPaperRate_hz = 15;
  constexpr int kWarmUp = 20;
  const std::filesystem::path scene = argc > 1 ? argv[1] : SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml";
  const int frames = argc > 2 ? std::atoi(argv[2]) : 300;
  SimulationDesc desc;
  desc.overrides = {{"laser_scanner", "method", argc > 3 ? argv[3] : "planar", "METHOD"}};

  Simulation simulation = Simulation::load(scene, desc);
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.type == "laser_scanner");
  const Trajectory drive(scene.parent_path() / "drive.csv", simulation.parameters());

  std::vector<double> milliseconds;
  double checksum = 0;
  for (int frame = 0; frame < kWarmUp + frames; ++frame) {
    drive.apply(static_cast<double>(simulation.next_frame().time_ns) / 1e9, simulation.parameters());
    const auto start = Clock::now();
    simulation.step();
    const double took = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (frame >= kWarmUp) milliseconds.push_back(took);
    for (const std::string& name : simulation.measured()) {
      for (const float range : simulation.scan(name).range_m) checksum += std::isfinite(range) ? range : 0;
    }
  }
  double total = 0;
  for (const double ms : milliseconds) total += ms;
  std::ranges::sort(milliseconds);
  const auto quantile = [&](double q) {
    return milliseconds[static_cast<std::size_t>(q * static_cast<double>(milliseconds.size() - 1))];
  };
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const double rate = frames / total * 1e3;
  const DeviceInfo* const device = simulation.diagnostics().device();
  std::printf("device,frames,sets_per_s,times_15_hz,median_ms,p99_ms,peak_mb,draws,triangles,checksum_m\n");
  std::printf("\"%s\",%d,%.0f,%.1f,%.3f,%.3f,%.0f,%llu,%llu,%.3f\n", device == nullptr ? "none" : device->name.c_str(),
              frames, rate, rate / kPaperRate_hz, quantile(0.5), quantile(0.99),
              static_cast<double>(usage.ru_maxrss) / 1024,
              static_cast<unsigned long long>(simulation.diagnostics().counters().draws),
              static_cast<unsigned long long>(simulation.diagnostics().counters().triangles), checksum);
  return 0;
}
