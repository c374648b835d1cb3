#include "program/cli/compare_run.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <simvis/location.h>
#include <simvis/simulation.h>
#include "engine/base/result_lock.h"
#include "exchange/fidelity/fidelity.h"
#include "program/cli/load_scene.h"
#include "program/cli/loading_bar.h"
#include "program/cli/warning_printer.h"
#include "program/output/atomic_file.h"
#include "program/output/new_folders.h"
#include "program/report/fidelity_report.h"
#include "simvis/built_scene.h"
#include "simvis/ignored_items.h"

namespace simvis {

namespace {

/// The only laser scanner that is turned on. The others are turned off.
std::string choose_scanner(Simulation& simulation) {
  std::string chosen, names;
  std::size_t count = 0;
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensor.enabled && (sensor.capabilities & kCastsBeams) != 0) {
      ++count;
      chosen = sensor.name;
      names += (names.empty() ? "" : ", ") + sensor.name;
    } else {
      simulation.enable(sensor.name, false);
    }
  }
  if (count == 0) throw InputError("--compare: the scene has no enabled laser scanner, expected the recorded one");
  if (count > 1)
    throw InputError("--compare: the scene has several laser scanners, expected --sensor with one of: " + names);
  return chosen;
}

double constant_of(const Measurement& measurement, std::string_view name, double absent) {
  for (const NamedValue& each : measurement.constants) {
    if (each.name == name) return each.value;
  }
  return absent;
}

}  // namespace

void compare_with_recording(const Options& options) {
  if (options.scene.empty()) throw InputError("--compare: SCENE.xml is missing, expected the scene of the recording");
  if (options.quiet && !options.names_out) {
    throw InputError("--compare: --quiet leaves nothing to print, expected --out DIR with it");
  }
  if (options.frames == 0) throw InputError("--compare: --frames 0 compares nothing, expected at least 1");
  std::optional<NewFolders> folders;  // made first: a long comparison does not end with a folder that cannot be made
  std::optional<ResultLock> lock;
  if (options.names_out) {
    folders.emplace(options.out);
    lock.emplace(std::filesystem::path(options.out) / "fidelity.json");
  }
  std::optional<LoadingBar> loading;
  loading.emplace(std::cerr, shows_progress(options));
  Options at_once = options;
  at_once.simulation.frames_when_due = true;  // the scanner measures in the first frame, whatever its rate
  Simulation simulation = load(at_once, loading);
  const std::string name = choose_scanner(simulation);
  simulation.step();
  loading.reset();
  WarningPrinter warnings(std::cerr);
  warnings.print_new(simulation);
  const Measurement measurement = simulation.measurement(name);
  const BuiltScene& built = built_scene(simulation);
  const ComparedScanner scanner{
      .name = name,
      .list = &simulation.diagnostics().draw_list(),
      .unseen = unseen_items(built, *std::ranges::find(built.sensors, name, &BuiltSensor::name)),
      .scan = &simulation.scan(name),
      .range_min_m = constant_of(measurement, "range_min_m", 0),
      .range_max_m = constant_of(measurement, "range_max_m", std::numeric_limits<double>::infinity())};
  const auto scans = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(options.names_frames ? options.frames : kComparedScans, UINT32_MAX - 1));
  FidelityReport report;
  in_option("--compare", [&] {
    report =
        compare_recording_file(options.compare, options.compare_topic, scans, scanner, {.fit_pose = options.fit_pose});
  });
  if (!options.quiet) std::cout << to_text(report);
  if (!options.names_out) return;
  const std::filesystem::path folder = options.out;
  for (const auto& [file, text] :
       {std::pair("fidelity.json", to_json(report)), std::pair("fidelity.svg", to_svg(report))}) {
    write_file(folder / file, text);
    if (!options.quiet) std::cout << "wrote " << (folder / file).string() << '\n';
  }
}

}  // namespace simvis
