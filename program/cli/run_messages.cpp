#include "program/cli/run_messages.h"

#include <algorithm>
#include <iostream>
#include <map>
#include <string>
#include <utility>

#include "elements/sensed_physics.h"
#include "program/cli/signals.h"
#include "program/report/explain.h"
#include "program/report/summary.h"
#include "simvis/built_scene.h"

namespace simvis {
namespace {

// What the run has loaded for its scene, and why; and what it has not.
std::string loaded_content(const Simulation& simulation) {
  const Diagnostics diagnostics = simulation.diagnostics();
  const Scene& scene = built_scene(simulation).scene;
  std::string text = "loaded:\n";
  for (const PartFile& each : scene.part_files()) {
    text += "  " + each.file.string() + ": " +
            (each.needed_by.empty() ? "not its shapes, which no sensor that is on sees"
                                    : "its shapes, for " + each.needed_by) +
            '\n';
  }
  if (scene.has_postponed_pictures()) {
    text += "  pictures of colours: not read, no sensor that is on shows them\n";
  } else if (!scene.pictures_needed_by().empty()) {
    text += "  pictures of colours: read, for " + scene.pictures_needed_by() + '\n';
  }
  const DeviceInfo* const device = diagnostics.device();
  const FramePlan* const visualization = diagnostics.visualization_plan();
  const bool draws =
      !diagnostics.frame_plan().passes.empty() || (visualization != nullptr && !visualization->passes.empty());
  if (device == nullptr) {
    text += "  Vulkan device: not opened, nothing is drawn\n";
  } else {
    text += "  Vulkan device: " + device->name + (draws ? ", for what is drawn\n" : ", to measure times\n");
  }
  text += find_physics(scene) == nullptr ? "  physics: not loaded, no element needs it\n"
                                         : "  physics: loaded, for the elements that it moves\n";
  return text;
}

}  // namespace

void print_explanation(const Simulation& simulation) {
  const Diagnostics diagnostics = simulation.diagnostics();
  std::cout << explain(diagnostics.frame_plan(), {diagnostics.counters(), diagnostics.planned_sensors(),
                                                  diagnostics.frame_costs(), diagnostics.sensor_costs()});
  for (const SensorInfo& sensor : simulation.sensors()) std::cout << sensor.report.explanation;
  std::cout << loaded_content(simulation);
  const FramePlan* const visualization = diagnostics.visualization_plan();
  if (visualization == nullptr) return;
  std::cout << "visualization, drawn apart:\n"
            << explain(*visualization, {*diagnostics.visualization_counters(), diagnostics.visualization_sensors(),
                                        diagnostics.visualization_costs(), diagnostics.sensor_costs()});
}

void print_closing(const Options& options, const std::filesystem::path& report_file,
                   std::span<const std::string> results, const RunReport& report) {
  std::cout << "wrote ";
  for (const std::string& result : results) std::cout << result << ", ";
  for (const std::string* const view : {&options.export_file, &options.page}) {
    if (!view->empty()) std::cout << *view << ", ";
  }
  if (report.recording) {
    std::cout << report.recording->file.string() << " (" << report.recording->messages << " messages";
    if (report.recording->dropped > 0) std::cout << ", " << report.recording->dropped << " dropped";
    std::cout << "), ";
  }
  for (std::size_t i = 0; i < report.packets.size(); ++i) {
    if (!report.packets[i]) continue;
    std::cout << options.record_pcap[i] << " (" << report.packets[i]->packets << " packets), ";
  }
  if (report.sent_packets) std::cout << report.sent_packets->packets << " packets by UDP, ";
  if (report.dds) std::cout << report.dds->messages << " messages by DDS, ";
  std::cout << report_file.string() << '\n' << speed_line(report) << '\n';
}

void print_summary(const Options& options, Simulation simulation, const std::optional<Trajectory>& trajectory,
                   const RunReport& report) {
  std::cout << to_text(
      summarize(std::move(simulation), {.rate_hz = options.simulation.rate_hz,
                                        .frame_ms = percentile(report.frame_ms.values(), 50),
                                        .later_frames = std::max<std::size_t>(report.frame_ms.added(), 1) - 1,
                                        .later_frames_s = report.later_frames_s,
                                        .out = options.out,
                                        .trajectory = trajectory ? &*trajectory : nullptr,
                                        .on_frame = stop_if_asked_to}));
}

void print_differences(const EarlierRun& run, const RunReport& report) {
  const std::map<std::string, std::string> now = depends_on(to_json(report));
  for (const char* const key : {"device", "driver", "versions"}) {
    const auto before = run.depends.find(key);
    if (before == run.depends.end() || before->second == now.at(key)) continue;
    std::cerr << "warning: " << run.report.string() << ": " << key << " was " << before->second << " and is "
              << now.at(key) << ", so the results may differ\n";
  }
}

}  // namespace simvis
