// Presets of RGB-D cameras that one can buy: figures of data sheets and papers as attributes of rgbd_camera.
#pragma once

#include <span>

#include <simvis/sensor_preset.h>

namespace simvis {

std::span<const SensorPreset> rgbd_camera_presets();

}  // namespace simvis
