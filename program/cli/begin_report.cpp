#include "program/cli/begin_report.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/sha256.h"
#include "exchange/messages/evt3.h"
#include "program/cli/load_scene.h"
#include "program/report/shard.h"

namespace simvis {
namespace {

/// Empty without --shard.
std::optional<Shard> wanted_shard(const Options& options, const Simulation& simulation) {
  std::optional<Shard> shard;
  if (options.shard.empty()) return shard;
  in_option("--shard", [&] {
    shard = parse_shard(options.shard);
    if (shard->share_of(options.frames) == 0) {
      throw InputError(options.shard + " has no frame of " + std::to_string(options.frames) +
                       ", expected K below --frames");
    }
    if (shard->count > 1) simulation.require_skippable();
  });
  return shard;
}

/// For a format that only event cameras have, so that nobody gets tables in its place without a word.
void require_event_camera(const Simulation& simulation, std::span<const SensorInfo> sensors) {
  std::string too_large;
  for (const SensorInfo& sensor : sensors) {
    const Measurement measurement = simulation.measurement(sensor.name);
    const CameraCalibration* const camera = measurement.calibration("");
    if (!sensor.enabled || camera == nullptr || measurement.find("polarity") == nullptr) continue;
    if (fits_evt3(camera->width_px, camera->height_px)) return;
    too_large = "the event camera \"" + sensor.name + "\" has " + std::to_string(camera->width_px) + " x " +
                std::to_string(camera->height_px) + " pixels, expected at most " + std::to_string(kMaxEvt3Size_px) +
                " x " + std::to_string(kMaxEvt3Size_px) + " for evt3";
  }
  throw InputError(too_large.empty() ? "the scene has no event_camera that is on, expected one for evt3" : too_large);
}

RunRecord begin_record(const Options& options, const Simulation& simulation, std::span<const SensorInfo> sensors) {
  RunRecord record;
  record.command = options.command;
  record.set = options.set;
  record.trajectory = options.trajectory;
  const std::span<const std::filesystem::path> inputs = simulation.diagnostics().inputs();
  std::vector<std::filesystem::path> files(inputs.begin(), inputs.end());
  files.insert(files.end(), options.plugins.begin(), options.plugins.end());
  record.inputs = hashes_of(files);
  for (const std::string& file : {options.trajectory, options.restore_state}) {
    if (!file.empty()) record.inputs[file] = sha256_of(file);
  }
  record.environment = simulation.diagnostics().environment();
  record.host = host_info();
  in_option("--format", [&] {
    record.formats = parse_formats(options.formats);
    if (record.formats.scan.contains("evt3")) require_event_camera(simulation, sensors);
  });
  record.formats.depth_unit_m = options.depth_unit_m;
  record.poses = options.poses;
  for (const SensorInfo& sensor : sensors) {
    const Command& command = simulation.diagnostics().command(sensor.name);
    record.attributes[sensor.name] = given_attributes(command);
    record.defaults[sensor.name] = default_attributes(command);
  }
  return record;
}

}  // namespace

RunReport begin_report(const Options& options, const Simulation& simulation) {
  RunReport report;
  report.scene = options.scene;
  report.shard = wanted_shard(options, simulation);
  if (const DeviceInfo* const device = simulation.diagnostics().device()) report.device = *device;
  report.seed = options.simulation.seed;
  report.rate_hz = options.simulation.rate_hz;
  report.frames_when_due = options.simulation.frames_when_due;
  report.frames_wanted = options.frames;
  report.endless = options.endless;
  if (!options.serve.empty()) report.served = serve_desc(options);
  report.followed = options.follow;
  report.sensors = simulation.sensors();
  report.record = begin_record(options, simulation, report.sensors);
  return report;
}

}  // namespace simvis
