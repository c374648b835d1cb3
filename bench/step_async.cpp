// Measures the gain of step_async(): frames of the moving marvin whose caller has its own work for each frame, with
// step() and with step_async() in turn.
//
//   step_async [FRAMES]
//
// Prints one CSV line for each method and each amount of work, as a share of a step: medians of a frame in
// milliseconds; the time that step_async() saves per frame; the upper limit of that, the smaller of work and device
// time; and the parts of a step before the submission to the device and after it.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>

namespace {

using simvis::Simulation;
using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

void work(double ms) {
  const Clock::time_point start = Clock::now();
  while (ms_since(start) < ms) {
  }
}

double stage_ms(const Simulation& simulation, std::string_view name) {
  for (const simvis::StageTime& stage : simulation.diagnostics().stages()) {
    if (stage.name == name) return static_cast<double>(stage.end_ns - stage.start_ns) / 1e6;
  }
  return 0;
}

Simulation load(const std::filesystem::path& scene, const std::string& method) {
  simvis::SimulationDesc desc;
  desc.overrides = {{"laser_scanner", "method", method, "METHOD"}};
  Simulation simulation = Simulation::load(scene, desc);
  for (const simvis::SensorInfo& sensor : simulation.sensors()) {
    simulation.enable(sensor.name, sensor.type == "laser_scanner");
  }
  return simulation;
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path scene = SIMVIS_SOURCE_DIR "/scenes/marvin/marvin.xml";
  const int frames = argc > 1 ? std::atoi(argv[1]) : 300;
  std::printf("method,work_share,step_ms,async_ms,saved_ms,at_most_ms,before_ms,render_ms,after_ms\n");
  for (const std::string method : {"planar", "raycast"}) {
    Simulation simulation = load(scene, method);
    const simvis::Trajectory drive(scene.parent_path() / "drive.csv", simulation.parameters());
    const auto apply = [&] {
      drive.apply(static_cast<double>(simulation.next_frame().time_ns) / 1e9, simulation.parameters());
    };
    std::vector<double> alone;
    for (int frame = 0; frame < 100; ++frame) {
      apply();
      const Clock::time_point start = Clock::now();
      simulation.step();
      if (frame >= 20) alone.push_back(ms_since(start));
    }
    const double step_ms = median(alone);
    for (const double share : {0.0, 0.25, 0.5, 1.0}) {
      std::vector<double> with_step, with_async, before, render, after;
      for (int frame = 0; frame < frames; ++frame) {
        Clock::time_point start = Clock::now();
        apply();
        simulation.step();
        work(share * step_ms);
        with_step.push_back(ms_since(start));
        before.push_back(stage_ms(simulation, "elements") + stage_ms(simulation, "flatten") +
                         stage_ms(simulation, "plan"));
        render.push_back(stage_ms(simulation, "render"));
        after.push_back(stage_ms(simulation, "collect"));
        start = Clock::now();
        apply();
        simulation.step_async();
        work(share * step_ms);
        simulation.finish();
        with_async.push_back(ms_since(start));
      }
      const double saved_ms = median(with_step) - median(with_async);
      std::printf("%s,%.2f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f\n", method.c_str(), share, median(with_step),
                  median(with_async), saved_ms, std::min(share * step_ms, median(render)), median(before),
                  median(render), median(after));
    }
  }
  return 0;
}
