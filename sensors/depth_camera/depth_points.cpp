#include <simvis/depth_points.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <simvis/pose.h>
#include "effects/camera/lens.h"

namespace simvis {
namespace {

// Where a ray reaches a depth along z. Rays of a fisheye may lead backwards, and their depths are then below 0.
glm::dvec3 at_depth(const glm::dvec3& ray, double depth_m) {
  const double length = depth_m / ray.z;
  return std::isfinite(depth_m) && length > 0 ? length * ray : glm::dvec3(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

bool is_pinhole(const CameraCalibration& camera) {
  return camera.distortion_model == "plumb_bob" &&
         std::ranges::all_of(camera.distortion_coefficients, [](double each) { return each == 0; });
}

std::vector<glm::dvec3> optical_points(const Image& depth, const CameraCalibration& camera) {
  const Pinhole& pinhole = camera.pinhole;
  std::optional<Lens> lens;
  if (!is_pinhole(camera)) {
    lens = lens_of(pinhole, camera.distortion_model, camera.distortion_coefficients);
    if (!lens) return {};
  }
  std::vector<glm::dvec3> points;
  points.reserve(depth.pixels.size());
  for (std::uint32_t y = 0; y < depth.height; ++y) {
    for (std::uint32_t x = 0; x < depth.width; ++x) {
      const glm::dvec2 pixel(x + 0.5, y + 0.5);
      const glm::dvec3 ray =
          lens ? lens->direction(pixel).value_or(glm::dvec3(0))
               : glm::dvec3((pixel.x - pinhole.cx_px) / pinhole.fx_px, (pixel.y - pinhole.cy_px) / pinhole.fy_px, 1);
      points.push_back(at_depth(ray, depth.pixels[points.size()]));
    }
  }
  return points;
}

std::optional<std::vector<glm::dvec3>> depth_points(const Measurement& measurement, std::string_view view) {
  const auto found = std::ranges::find_if(measurement.arrays, [&](const MeasuredArray& each) {
    return each.content == ImageContent::depth && each.view == view;
  });
  const CameraCalibration* const camera = measurement.calibration(view);
  if (found == measurement.arrays.end() || camera == nullptr) return std::nullopt;
  const std::optional<Image> depth = to_image(*found);
  if (!depth) return std::nullopt;
  std::vector<glm::dvec3> points = optical_points(*depth, *camera);
  if (points.size() != depth->pixels.size()) return std::nullopt;
  const glm::dmat3 sensor_from_optical(sensor_from_view());
  const glm::dvec3 centre_m(0, -camera->baseline_m, 0);
  for (glm::dvec3& point : points) point = sensor_from_optical * point + centre_m;
  return points;
}

}  // namespace simvis
