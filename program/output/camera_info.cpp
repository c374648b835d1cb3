#include "program/output/camera_info.h"

#include <vector>

#include "program/output/yaml_text.h"

namespace simvis {

namespace {

std::string matrix(const std::string& name, int rows, int columns, const std::vector<double>& values) {
  std::string data;
  for (const double value : values) data += (data.empty() ? "" : ", ") + yaml_number(value);
  return name + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) + "\n  data: [" + data +
         "]\n";
}

}  // namespace

std::string camera_info_yaml(const std::string& name, const CameraCalibration& info) {
  const double fx = info.pinhole.fx_px, fy = info.pinhole.fy_px;
  const double cx = info.pinhole.cx_px - 0.5, cy = info.pinhole.cy_px - 0.5;
  const double tx = info.baseline_m == 0 ? 0.0 : -fx * info.baseline_m;
  return "image_width: " + std::to_string(info.width_px) + "\nimage_height: " + std::to_string(info.height_px) +
         "\ncamera_name: " + yaml_quoted(name) + "\n" + matrix("camera_matrix", 3, 3, {fx, 0, cx, 0, fy, cy, 0, 0, 1}) +
         "distortion_model: " + info.distortion_model + "\n" +
         matrix("distortion_coefficients", 1, static_cast<int>(info.distortion_coefficients.size()),
                info.distortion_coefficients) +
         matrix("rectification_matrix", 3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1}) +
         matrix("projection_matrix", 3, 4, {fx, 0, cx, tx, 0, fy, cy, 0, 0, 0, 1, 0});
}

}  // namespace simvis
