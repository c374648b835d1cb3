// Laser scanners that one can buy: what their data sheets say, as attributes of laser_scanner.
#pragma once

#include <span>

#include <simvis/sensor_preset.h>

namespace simvis {

/// Angles so that the middle looks along x; a noise that a data sheet bounds is taken at its bound.
std::span<const SensorPreset> laser_scanner_presets();

}  // namespace simvis
