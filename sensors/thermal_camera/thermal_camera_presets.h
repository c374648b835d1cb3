// Presets of thermal cameras that one can buy: figures of data sheets as attributes of thermal_camera.
#pragma once

#include <span>

#include <simvis/sensor_preset.h>

namespace simvis {

std::span<const SensorPreset> thermal_camera_presets();

}  // namespace simvis
