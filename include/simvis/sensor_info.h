// A description of each sensor of a simulation.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/sensor.h>

namespace simvis {

/// A sensor of the scene, as run.json and users see it.
struct SensorInfo {
  std::string name,                             ///< the sensor's name
      type,                                     ///< its type
      method;                                   ///< how it measures, see Sensor::method()
  std::uint64_t frames = 0;                     ///< number of measurements so far
  bool enabled = true;                          ///< false: turned off
  SensorReport report{};                        ///< on its last measurement
  std::optional<double> depth_error_bound_m{};  ///< of its last depth image; empty unless with_bounds() sets it
  std::vector<std::string> effects{};           ///< effects that any of its measurements had, as the plan named them
  double rate_hz = 0;                           ///< measurements per second; 0: every frame

  /// The note of the report with this name, if it is a number; empty otherwise.
  std::optional<double> number(std::string_view note) const;
};

}  // namespace simvis
