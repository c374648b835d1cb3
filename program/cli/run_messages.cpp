#include "program/cli/run_messages.h"

#include <algorithm>
#include <iostream>
#include <map>
#include <string>
#include <utility>

#include "program/cli/signals.h"
#include "program/report/explain.h"
#include "program/report/summary.h"

namespace simvis {

void print_explanation(const Simulation& simulation) {
  const Diagnostics diagnostics = simulation.diagnostics();
  std::cout << explain(diagnostics.frame_plan(), {diagnostics.counters(), diagnostics.planned_sensors(),
                                                  diagnostics.frame_costs(), diagnostics.sensor_costs()});
  for (const SensorInfo& sensor : simulation.sensors()) std::cout << sensor.report.explanation;
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
  if (report.packets) std::cout << options.record_pcap << " (" << report.packets->packets << " packets), ";
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
