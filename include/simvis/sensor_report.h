// What a sensor says of itself and of its measurements, for run.json, `--explain` and users.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <simvis/export.h>

namespace simvis {

/// One entry about a sensor in run.json.
struct SensorNote {
  std::string name;                                        ///< the key
  std::variant<double, std::uint64_t, std::string> value;  ///< the value
};

/// What a sensor reports about its measurements in addition to its method.
struct SensorReport {
  std::vector<SensorNote> notes;  ///< for run.json, in this order; names as there
  std::string explanation;        ///< for --explain: whole lines
};

/// A sensor of the scene, as run.json and users see it.
struct SIMVIS_API SensorInfo {
  std::string name,                             ///< the sensor's name
      type,                                     ///< its type
      method;                                   ///< how it measures, see Sensor::method()
  std::uint64_t frames = 0;                     ///< number of measurements so far
  bool enabled = true;                          ///< false: turned off
  SensorReport report{};                        ///< on its last measurement
  std::optional<double> depth_error_bound_m{};  ///< of its last depth image; empty unless with_bounds() sets it
  std::vector<std::string> effects{};           ///< effects that any of its measurements had, as the plan named them
  std::uint8_t capabilities = 0;                ///< of its type, as a sum of SensorCapability
  double rate_hz = 0;                           ///< measurements per second; 0: every frame

  /// The note of the report with this name, if it is a number; empty otherwise.
  std::optional<double> number(std::string_view note) const;
};

}  // namespace simvis
