#include "program/cli/written_sensors.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include <simvis/attributes.h>
#include "sensors/laser_scanner/laser_scanner.h"
#include "sensors/timing_faults.h"
#include "simvis/built_scene.h"
#include "simvis/element_motion.h"

namespace simvis {
namespace {

/// Whether a scan of this frame says which items its beams hit.
bool names_items(const Simulation& simulation, const WrittenSensors& written) {
  const std::vector<SensorInfo> sensors = simulation.sensors();
  return std::ranges::any_of(simulation.measured(), [&](const std::string& name) {
    const auto sensor = std::ranges::find(sensors, name, &SensorInfo::name);
    const bool casts = sensor != sensors.end() && (sensor->capabilities & kCastsBeams) != 0;
    return casts && written.contains(name) && simulation.scan(name).find(kTrueItem) != nullptr;
  });
}

/// Whether a sensor of this frame gives the ids of objects or shapes.
bool gives_ids(const Simulation& simulation, const WrittenSensors& written) {
  const std::vector<BuiltSensor>& sensors = built_scene(simulation).sensors;
  return std::ranges::any_of(simulation.measured(), [&](const std::string& name) {
    const auto sensor = std::ranges::find(sensors, name, &BuiltSensor::name);
    if (sensor == sensors.end() || !written.contains(name)) return false;
    const SensorNeeds needs = sensor->sensor->needs();
    return needs.item_ids || !needs.contacts_of.empty();
  });
}

/// A line for each measurement of this frame that has timing faults.
std::vector<std::string> timing_lines(const Simulation& simulation, const WrittenSensors& written) {
  std::vector<std::string> lines;
  for (const BuiltSensor& sensor : built_scene(simulation).sensors) {
    if (sensor.delayed == nullptr || !written.contains(sensor.name) ||
        std::ranges::count(simulation.measured(), sensor.name) == 0) {
      continue;
    }
    const Measurement measurement = simulation.measurement(sensor.name);
    std::string line = csv_field(sensor.name);
    for (const double time_s : {static_cast<double>(measurement.time_ns) / 1e9, *measurement.value(kCaptureTime),
                                *measurement.value(kArrivalTime)}) {
      char text[32];
      std::snprintf(text, sizeof text, ",%.9f", time_s);
      line += text;
    }
    lines.push_back(line);
  }
  return lines;
}

}  // namespace

std::string drawn_lines(const Simulation& simulation, const FrameTime& time) {
  std::string lines;
  for (const DrawnValue& drawn : drawn_values(built_scene(simulation), random_key(time))) {
    lines += std::to_string(time.index) + "," + csv_field(drawn.element) + "," + csv_field(drawn.parameter) + "," +
             format_number(drawn.value) + "\n";
  }
  return lines;
}

void WrittenSensors::start(std::set<std::string> names, const Simulation& simulation) {
  names_ = std::move(names);
  changes_ = simulation.parameters().changes().size();
}

void WrittenSensors::follow(const Simulation& simulation) {
  const std::vector<std::string>& log = simulation.parameters().changes();
  for (; changes_ < log.size(); ++changes_) {
    const Command command = parse_commands(log[changes_], "log", ".").front();
    if (command.kind != CommandKind::remove || command.require("kind").value != "sensor") continue;
    names_.erase(command.require("name").value);
  }
}

void write_results(const std::vector<std::string>& parts, const Simulation& simulation, const WrittenSensors& written,
                   const FrameTime& time, OutputWriter& writer) {
  glm::dmat4 pose;
  for (const std::string& part : parts) {
    if (simulation.part_pose(part, pose)) writer.part_pose(part, time, pose);
  }
  for (const std::string& sensor : simulation.measured()) {
    if (!written.contains(sensor)) continue;
    const Measurement measurement = simulation.measurement(sensor);
    FrameTime stamped = time;  // of a follower that of its host
    stamped.time_ns += measurement.time_ns - simulation.last_frame()->time_ns;
    writer.write(sensor, stamped, measurement.world_from_sensor, measurement);
  }
  if (std::vector<std::string> lines = timing_lines(simulation, written); !lines.empty()) {
    writer.scene_table(kTimingTable, time, std::move(lines));
  }
  if (std::string lines = drawn_lines(simulation, time); !lines.empty()) writer.drawn(std::move(lines));
  if (names_items(simulation, written)) writer.scene_table(kItemTable, time, item_lines(simulation.items()));
  if (gives_ids(simulation, written)) {
    writer.scene_table(kObjectTable, time, object_lines(simulation.objects()));
    writer.scene_table(kShapeTable, time, shape_lines(simulation.items()));
  }
  writer.end_frame();
}

}  // namespace simvis
