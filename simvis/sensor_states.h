// What a simulation keeps of each of its sensors: state, last measurement, cost.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/element.h>
#include <simvis/measurement.h>
#include <simvis/scan.h>
#include <simvis/state_archive.h>
#include <simvis/step_costs.h>
#include "simvis/scene_builder.h"

namespace simvis {

struct SensorState {
  std::size_t sensor = 0;  ///< BuiltSensor::id
  bool enabled = true;
  std::uint64_t frames = 0;                  ///< in which it has measured
  bool has_measured = false;                 ///< in this simulation, whose state may be that of another one
  glm::dmat4 world_from_sensor{1.0};         ///< at its last measurement
  std::vector<std::string> effects{};        ///< names of the effects it has had
  bool rate_checked = false;                 ///< whether the frames keep its rate
  std::optional<Measurement> measurement{};  ///< the last one, checked; empty until it is read
};

/// The last scan of a restored state.
struct RestoredScan {
  Scan scan;
  std::uint64_t frames = 0;  ///< SensorState::frames at that scan
};

/// A scan that is shown in place of a sensor's own one.
struct ShownScan {
  Scan scan;
  std::uint64_t count = 0;  ///< of the scans that were shown for the sensor
};

struct SensorStates {
  /// `sensors` are those of the scene; they outlive the states.
  explicit SensorStates(const std::vector<BuiltSensor>& sensors) : built(sensors) {}

  /// Follows a change of the scene; calls `added` for each new sensor. Returns whether any sensor was removed.
  bool follow(const std::function<void(const BuiltSensor&)>& added);
  /// Throws InputError if there is no sensor of this name.
  std::size_t index(std::string_view name) const;
  /// The rates of the sensors that are on and have one.
  std::vector<double> rates() const;
  /// The last measurement of a sensor. All readers use this function, which checks each measurement once.
  const Measurement& measurement(std::size_t index);
  const Measurement& measurement(std::string_view name) { return measurement(index(name)); }
  /// What visualization elements show of a sensor: the scan that was shown in its place, or its own last one.
  ObservedScan scan(std::string_view name) const;

  /// Writes or reads the scans that visualization elements observe, but those of show_scan().
  void archive_scans(StateArchive& state);

  void begin_frame();
  void add_measured(std::size_t index);
  /// The frame counts as not made.
  void discard_frame();

  ObservedScan own_scan(std::size_t index) const;

  const std::vector<BuiltSensor>& built;
  std::vector<SensorState> all;                  ///< as long as `built`, after follow()
  std::vector<std::string> measured;             ///< names of the sensors that measured in this frame
  std::vector<SensorCost> costs;                 ///< of those, if the device is instrumented
  std::map<std::size_t, ShownScan> shown;        ///< by BuiltSensor::id
  std::map<std::size_t, RestoredScan> restored;  ///< the same; what visualization elements show until the next scan
};

}  // namespace simvis
