#include "program/cli/dataset_run.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include <simvis/location.h>
#include "program/cli/written_sensors.h"
#include "program/datasets/dataset_format.h"
#include "program/datasets/seen_view.h"
#include "program/report/earlier_run.h"
#include "sensors/camera/keypoints.h"
#include "simvis/built_scene.h"

namespace simvis {
namespace {

/// What the bytes depend on, which all shards share.
std::map<std::string, std::string> shared_dependencies(const RunReport& report) {
  std::map<std::string, std::string> depends = depends_on(to_json(report));
  for (const char* const key : {"shard", "formats", "poses"}) depends.erase(key);
  return depends;
}

std::filesystem::path folder_of(const Options& options, const std::string& format) {
  return options.datasets.size() == 1 ? std::filesystem::path(options.out)
                                      : std::filesystem::path(options.out) / format;
}

DatasetDesc dataset_desc(const Options& options, const RunReport& report, const std::string& format) {
  if (options.endless) throw InputError("--dataset: the run has no last frame, expected --frames or --trajectory");
  if (std::ranges::count(options.datasets, format) > 1) {
    throw InputError("--dataset: " + in_quotes(format) + " is given twice, expected each format once");
  }
  return {.folder = folder_of(options, format),
          .format = format,
          .depth_unit_m = options.depth_unit_m,
          .frames = options.frames,
          .depends = shared_dependencies(report),
          .shard = report.shard ? report.shard->suffix() : "",
          .resume = options.resume,
          .threads = options.simulation.threads};
}

/// The names of the points of a sensor of keypoints; none of another sensor.
std::map<std::uint32_t, std::string> points_of(const Simulation& simulation, const std::string& name) {
  for (const SensorInfo& sensor : simulation.sensors()) {
    if (sensor.name == name) return keypoint_names(sensor.report);
  }
  return {};
}

std::vector<DatasetSensor> sensors_of(const Simulation& simulation, std::vector<std::string> names) {
  std::ranges::sort(names);
  std::vector<DatasetSensor> sensors;
  for (const std::string& name : names) {
    DatasetSensor sensor{.name = name, .measurement = simulation.measurement(name)};
    sensor.world_from_sensor = sensor.measurement.world_from_sensor;
    if (is_keypoints(sensor)) sensor.points = points_of(simulation, sensor.name);
    sensors.push_back(std::move(sensor));
  }
  return sensors;
}

// A frame of a dataset is one moment of all sensors.
std::vector<std::string> without_timing_faults(const Simulation& simulation, std::vector<std::string> names) {
  for (const BuiltSensor& sensor : built_scene(simulation).sensors) {
    if (sensor.delayed == nullptr || std::ranges::count(names, sensor.name) == 0) continue;
    fail_at(sensor.command.where, "sensor " + in_quotes(sensor.name) +
                                      ": a dataset has no measurements with timing faults, expected a sensor without "
                                      "delay, drop, freeze, clock and stamp, or --sensor without it");
  }
  return names;
}

std::vector<std::string> enabled(const RunReport& report) {
  std::vector<std::string> names;
  for (const SensorInfo& sensor : report.sensors) {
    if (sensor.enabled) names.push_back(sensor.name);
  }
  return names;
}

}  // namespace

DatasetRun::DatasetRun(const Options& options, const RunReport& report, Simulation& simulation)
    : options_(options), simulation_(simulation) {
  const std::vector<DatasetSensor> sensors = sensors_of(simulation, without_timing_faults(simulation, enabled(report)));
  // All formats take the sensors before the first one claims its folder.
  for (const std::string& format : options.datasets) {
    make_dataset_format(format, options.depth_unit_m)->begin(sensors);
  }
  for (const std::string& format : options.datasets) {
    folders_.push_back(std::make_unique<DatasetFolder>(dataset_desc(options, report, format), sensors));
  }
}

bool DatasetRun::has(std::uint64_t frame) const {
  return std::ranges::all_of(folders_, [&](const auto& folder) { return folder->has(frame); });
}

bool DatasetRun::has_all() const {
  return std::ranges::all_of(folders_, [](const auto& folder) { return folder->has_all(); });
}

void DatasetRun::frame(const FrameTime& time) {
  const std::span<const std::string> measured = simulation_.measured();
  const std::vector<DatasetSensor> sensors = sensors_of(simulation_, {measured.begin(), measured.end()});
  const std::vector<SceneItem> items = simulation_.items();
  const std::vector<SceneObject> objects = simulation_.objects();
  const std::string drawn = drawn_lines(simulation_, time);
  const DatasetFrame made{time, sensors, items, objects, simulation_.diagnostics().draw_list()};
  const auto warn = [this](const std::string& warning) { simulation_.warn(warning); };
  for (const std::unique_ptr<DatasetFolder>& folder : folders_) folder->add(made, drawn, warn);
}

void DatasetRun::finish() {
  for (std::size_t i = 0; i < folders_.size(); ++i) {
    const bool is_whole = folders_[i]->finish();
    if (options_.quiet) continue;
    const std::filesystem::path folder = folder_of(options_, options_.datasets[i]);
    const bool has_sheet = std::filesystem::exists(folder / "contact_sheet.png");
    std::cout << "wrote frames of a dataset (" << options_.datasets[i] << ") to " << folder.string()
              << (is_whole ? ": all " + std::to_string(options_.frames) + " frames are there"
                           : ": other frames are missing, and with them the files of the whole")
              << (is_whole && has_sheet ? ", see contact_sheet.png\n" : "\n");
  }
}

}  // namespace simvis
