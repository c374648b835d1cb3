// The columns of a laser scanner's table that do not come from its effects.
#pragma once

#include <vector>

#include <simvis/sensor.h>

namespace simvis {

/// Those of every scan, the channels of its effects, and those of truth.
std::vector<OutputSpec> laser_scanner_outputs(const SensorContext& context);

}  // namespace simvis
