// Presets of commercial laser scanners: data sheet values as attributes of laser_scanner.
#pragma once

#include <span>

#include <simvis/sensor.h>

namespace simvis {

/// The middle of the field of view is +x. Beams of devices with a table are those of the table. If a data sheet gives a
/// bound for the noise, the bound is used.
std::span<const SensorPreset> laser_scanner_presets();

}  // namespace simvis
