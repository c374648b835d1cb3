// The columns of a laser scanner's table that do not come from its effects.
#pragma once

#include <vector>

#include <simvis/sensor.h>

namespace simvis {

/// Those of every scan, in the order in which LaserScanner::write() fills them.
const std::vector<TableColumn>& scan_columns();

/// The columns of the scan's table, the channels of its effects, and those of truth.
std::vector<OutputSpec> laser_scanner_outputs(const SensorContext& context);

}  // namespace simvis
