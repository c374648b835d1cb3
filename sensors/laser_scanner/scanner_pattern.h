// The attributes `pattern`, `pattern_beams` and `pattern_rate` of a laser scanner.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include <simvis/output_spec.h>
#include <simvis/sensor_type.h>
#include "sensors/beam_tables/beam_table.h"

namespace simvis {

/// How a `pattern` begins that is the name of a device and not of a file.
inline constexpr std::string_view kDevicePrefix = "device:";

struct ScannerPattern {
  std::shared_ptr<const BeamTable> table;
  std::uint32_t beams_of_scan = 0;  ///< of a table that runs on; 0: every scan has all beams
  OutputShape shape{};              ///< rings and beams of a scan
};

/// Empty if the command has no pattern. Throws InputError at an attribute that does not go with a pattern, and that of
/// the file.
std::optional<ScannerPattern> scanner_pattern(const SensorContext& context);

}  // namespace simvis
