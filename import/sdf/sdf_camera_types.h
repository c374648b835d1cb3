// The sensors of SDF that are cameras here: their types, and what the camera measures.
#pragma once

#include <algorithm>
#include <iterator>
#include <string_view>

namespace simvis {

struct SdfCameraType {
  std::string_view name;
  const char* type;
  std::string_view outputs;
};
inline constexpr SdfCameraType kSdfCameraTypes[] = {
    {"camera", "camera", "color"},
    {"wideanglecamera", "camera", "color"},
    {"wide_angle_camera", "camera", "color"},
    {"depth", "camera", "depth"},
    {"depth_camera", "camera", "depth"},
    {"rgbd", "camera", "color depth"},
    {"rgbd_camera", "camera", "color depth"},
    {"segmentation", "camera", "semantic instance"},
    {"segmentation_camera", "camera", "semantic instance"},
    {"boundingbox", "camera", "color boxes"},
    {"boundingbox_camera", "camera", "color boxes"},
    {"thermal", "thermal_camera", "raw16 temperature"},
    {"thermal_camera", "thermal_camera", "raw16 temperature"},
};

/// Null: sensors of this type are no cameras.
inline const SdfCameraType* find_sdf_camera_type(std::string_view name) {
  const auto* const found = std::ranges::find(kSdfCameraTypes, name, &SdfCameraType::name);
  return found == std::end(kSdfCameraTypes) ? nullptr : found;
}

}  // namespace simvis
