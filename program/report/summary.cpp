#include "program/report/summary.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include "program/report/run_report.h"
#include "simvis/time/clock.h"

namespace simvis {

namespace {

constexpr std::uint64_t kWarmUp = 2, kFrames = 15;  // about 0.1 s with any method on two cores

bool casts_beams(const SensorInfo& sensor) { return (sensor.capabilities & kCastsBeams) != 0; }

template <typename... Values>
std::string formatted(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

/// A share that is not 0 never reads as 0.
std::string beams_text(double share) {
  if (share >= 0.01) return formatted("%.2g %% of the beams", 100 * share);
  return share > 0 ? formatted("1 in %.0f beams", 1 / share) : "no beam";
}

/// Beams without an error bound, such as those at silhouettes, are listed apart: a few of them hit another surface.
std::string errors_text(const ScannerCosts& costs, const VariantCosts& variant) {
  std::string text;
  if (variant.unbounded_share < 1) text += formatted(", error up to %.1e m", bounded_error_m(costs, variant));
  if (variant.unbounded_share > 0) {
    text += ", no bound for " + beams_text(variant.unbounded_share);
    if (!std::isnan(variant.unbounded_difference_m)) {
      text += formatted(" (error up to %.1e m)", variant.unbounded_difference_m);
    }
  }
  if (std::isnan(variant.wrong_kind_share)) return text;  // there is nothing exact to compare with
  return text + ", wrong hit or miss for " + beams_text(variant.wrong_kind_share);
}

/// Counts the scanners that measured in the last step and their beams. Only scanners were enabled in that step.
void take_set(const Simulation& simulation, RunSummary& summary) {
  summary.scanners = simulation.measured().size();
  summary.beams = 0;
  for (const std::string& name : simulation.measured()) summary.beams += simulation.scan(name).range_m.size();
}

/// Times sets: frames in which the largest number of scanners measures. Returns the first scanner of a set.
std::string measure_sets(Simulation& simulation, const SummaryDesc& desc, RunSummary& summary) {
  using SteadyClock = std::chrono::steady_clock;
  const Clock clock(desc.rate_hz);
  std::vector<double> times_ms;
  std::string first;
  for (std::uint64_t frame = 0; frame < kWarmUp + kFrames; ++frame) {
    if (desc.trajectory != nullptr) {
      desc.trajectory->apply(static_cast<double>(clock.frame(frame).time_ns) / 1e9, simulation.parameters());
    }
    const SteadyClock::time_point start = SteadyClock::now();
    simulation.step();
    const double took_ms = std::chrono::duration<double, std::milli>(SteadyClock::now() - start).count();
    if (desc.on_frame) desc.on_frame();
    if (simulation.measured().size() > summary.scanners) {
      take_set(simulation, summary);
      first = simulation.measured().front();
      times_ms.clear();
    }
    if (frame < kWarmUp || simulation.measured().empty()) continue;
    if (simulation.measured().size() == summary.scanners) times_ms.push_back(took_ms);
  }
  summary.set_ms = percentile(times_ms, 50);
  if (times_ms.empty()) summary.scanners = 0;
  return first;
}

/// The existing files among: one image, preferably one for people; the table of one scanner; run.json.
std::vector<std::filesystem::path> first_files(const Simulation& simulation, const std::filesystem::path& out) {
  std::filesystem::path picture, scan;
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (!sensor.enabled) continue;
    const std::filesystem::path png = out / sensor.name / "000000.png", csv = out / (sensor.name + ".csv");
    const CommandAttribute* const view = simulation.diagnostics().command(sensor.name).find("view");
    const bool for_people = view != nullptr && view->value == "visualization";
    if ((picture.empty() || for_people) && std::filesystem::exists(png)) picture = png;
    if (scan.empty() && casts_beams(sensor) && std::filesystem::exists(csv)) scan = csv;
  }
  std::vector<std::filesystem::path> files{picture, scan, out / "run.json"};
  std::erase_if(files, [](const std::filesystem::path& file) { return !std::filesystem::exists(file); });
  return files;
}

}  // namespace

RunSummary summarize(Simulation simulation, const SummaryDesc& desc) {
  RunSummary summary{.rate_hz = desc.rate_hz, .frame_ms = desc.frame_ms};
  if (desc.later_frames > 0) summary.wall_hz = static_cast<double>(desc.later_frames) / desc.later_frames_s;
  summary.files = first_files(simulation, desc.out);
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (!sensor.enabled || casts_beams(sensor)) continue;
    simulation.enable(sensor.name, false);
    ++summary.cameras;
  }
  const std::string priced = measure_sets(simulation, desc, summary);
  if (summary.scanners == 0) return summary;
  for (const SensorInfo& sensor : simulation.sensors()) simulation.enable(sensor.name, sensor.name == priced);
  CostDesc costs{.rate_hz = desc.rate_hz, .trajectory = desc.trajectory, .variants = &ScanVariants::by_method};
  costs.on_frame = [&](std::uint64_t, std::uint64_t) {
    if (desc.on_frame) desc.on_frame();
  };
  summary.costs = scanner_costs(std::move(simulation), costs).front();
  return summary;
}

double bounded_error_m(const ScannerCosts& costs, const VariantCosts& variant) {
  const std::optional<std::size_t> exact = reference_of(costs.variants);
  return std::fmax(variant.difference_largest_m,
                   exact ? costs.variants[*exact].bound_largest_m : variant.bound_largest_m);
}

std::string to_text(const RunSummary& summary) {
  std::string text;
  if (summary.scanners > 0) {
    const double sets_hz = 1000 / summary.set_ms;
    text += formatted("scanners: %zu with %llu beams together, %.2f ms a set: %.0f sets per second, %.0f x %g Hz\n",
                      summary.scanners, static_cast<unsigned long long>(summary.beams), summary.set_ms, sets_hz,
                      sets_hz / summary.rate_hz, summary.rate_hz);
  }
  if (summary.cameras > 0) {
    const double rest_ms = std::max(summary.frame_ms - summary.set_ms, 0.0);
    text += formatted("cameras: %.0f %% of a frame of %.1f ms\n", 100 * rest_ms / summary.frame_ms, summary.frame_ms);
  }
  if (summary.wall_hz > 0) {
    text += formatted("wall clock: %.1f frames per second with their files, from the second frame on: %.2f x %g Hz\n",
                      summary.wall_hz, summary.wall_hz / summary.rate_hz, summary.rate_hz);
  }
  if (summary.costs) {
    text += "what accuracy costs " + summary.costs->scanner + " (--price lists more):\n";
    for (const VariantCosts& each : summary.costs->variants) {
      const std::string& method = each.variant.method.empty() ? kNoMethod : each.variant.method;
      text += formatted("  %-8s %8.3f ms", method.c_str(), each.median_ms) + errors_text(*summary.costs, each) + "\n";
    }
  }
  std::string files;
  for (const std::filesystem::path& file : summary.files) files += (files.empty() ? "" : ", ") + file.string();
  return text + "open first: " + files + "\n";
}

}  // namespace simvis
