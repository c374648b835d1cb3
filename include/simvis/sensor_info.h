// What a simulation knows of each of its sensors.
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
  std::string name, type, method;
  std::uint64_t frames = 0;  ///< how often it has measured
  bool enabled = true;
  SensorReport report{};                        ///< of its last measurement
  std::optional<double> depth_error_bound_m{};  ///< of its last depth image; empty unless asked for, see with_bounds()
  std::vector<std::string> effects{};           ///< that any of its measurements had, as the plan named them

  /// A note of the report that is a number, by its name; empty if there is none.
  std::optional<double> number(std::string_view note) const;
};

}  // namespace simvis
