#include "sensors/camera/pixel_optics.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "sensors/camera/camera_views.h"
#include "sensors/camera/pinhole_view.h"

namespace simvis {
namespace {

// Where a lens is straight: the derivative is wrong by this share squared, and by rounding by 1e-10 of itself.
constexpr double kStraight_rad = 1e-6;
// Each step leaves a thousandth of the error: a square is small against the curvature of a lens.
constexpr int kRaySteps = 8;

// Of axes that are perpendicular to the ray and to each other; x to the right, y down.
glm::dmat3 frame_around(const glm::dvec3& ray) {
  const glm::dvec3 down = std::abs(ray.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
  const glm::dvec3 x = glm::normalize(glm::cross(down, ray));
  return glm::transpose(glm::dmat3(x, glm::cross(ray, x), ray));
}

double larger_singular_value(const glm::dmat2& m) {
  const double sum = glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]), det = glm::determinant(m);
  return std::sqrt((sum + std::sqrt(std::max(sum * sum - 4 * det * det, 0.0))) / 2);
}

}  // namespace

PixelOptics::PixelOptics(const std::string& sensor, CameraLayout layout, double near_m)
    : layout_(std::move(layout)),
      near_m_(near_m),
      calibrations_(simvis::calibrations({{.view = "", .camera = calibration_of(layout_)}})) {
  const auto refuse = [&](const char* what) {
    throw InputError("sensor " + in_quotes(sensor) + ": an effect " + what + ", expected another effect");
  };
  if (layout_.row_time_s != 0 || !layout_.exposure.one_picture()) refuse("sets times of rows or an exposure");
  if (!has_lens()) return;
  if (layout_.pixel_of == nullptr) refuse("does not say where its lens shows a direction");
  const CameraViews views = camera_views(layout_, 1);
  is_wide_ =
      std::ranges::any_of(views.views, [](const CameraView& view) { return view.face_from_view != glm::dmat3(1); });
}

glm::dvec3 PixelOptics::direction(std::uint32_t pixel, const glm::dvec2& offset_px) const {
  const std::uint32_t column = pixel % layout_.width_px, row = pixel / layout_.width_px;
  const double x = column + 0.5 + offset_px.x, y = row + 0.5 + offset_px.y;
  if (!has_lens()) {
    const Pinhole& p = layout_.pinhole;
    return glm::normalize(glm::dvec3((x - p.cx_px) / p.fx_px, (y - p.cy_px) / p.fy_px, 1));
  }
  if (offset_px == glm::dvec2(0)) return layout_.rays[pixel];
  const PixelSquare square = this->square(pixel);
  if (square.focal_px == 0) return glm::dvec3(0);
  const glm::dmat3 view_from_square = glm::inverse(square.square_from_view);
  glm::dvec2 place_px = offset_px;  // in the square
  glm::dvec3 ray(0);
  for (int step = 0; step < kRaySteps; ++step) {
    ray = glm::normalize(view_from_square * glm::dvec3(place_px / square.focal_px, 1));
    const std::optional<glm::dvec2> seen = layout_.pixel(ray);
    if (!seen) return glm::dvec3(0);
    place_px += glm::dvec2(x, y) - *seen;
  }
  return ray;
}

// The views of a wide lens are the faces of a cube.
double PixelOptics::near_range_m(const glm::dvec3& direction) const {
  if (!is_wide_) return near_m_ / direction.z;
  return near_m_ / std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
}

bool PixelOptics::shows(const glm::dvec3& point_m) const {
  glm::dvec2 seen;
  if (has_lens()) {
    const std::optional<glm::dvec2> pixel = layout_.pixel(point_m);
    const double range_m = glm::length(point_m);
    if (!pixel || range_m <= near_range_m(point_m / range_m)) return false;
    seen = *pixel;
  } else {
    if (point_m.z <= near_m_) return false;
    const Pinhole& p = layout_.pinhole;
    seen = {p.fx_px * point_m.x / point_m.z + p.cx_px, p.fy_px * point_m.y / point_m.z + p.cy_px};
  }
  return seen.x >= 0 && seen.x <= layout_.width_px && seen.y >= 0 && seen.y <= layout_.height_px;
}

PixelSquare PixelOptics::square(std::uint32_t pixel) const {
  const glm::dvec3& ray = layout_.rays[pixel];
  if (ray == glm::dvec3(0)) return {};
  const glm::dmat3 around_from_view = frame_around(ray);
  glm::dmat2 jacobian;  // pixels by tangents
  for (int axis = 0; axis < 2; ++axis) {
    glm::dvec3 aside(0, 0, 1);
    aside[axis] = kStraight_rad;
    const auto after = layout_.pixel(aside * around_from_view);
    aside[axis] = -kStraight_rad;
    const auto before = layout_.pixel(aside * around_from_view);
    if (!after || !before) return {};
    jacobian[axis] = (*after - *before) / (2 * kStraight_rad);
  }
  const double focal_px = larger_singular_value(jacobian);
  glm::dmat3 square_from_around(jacobian / focal_px);
  square_from_around[2] = {0, 0, 1};
  return {square_from_around * around_from_view, focal_px, near_range_m(ray)};
}

Measurement PixelOptics::measurement(const SensorMoment& of) const {
  return {.time_ns = of.time.time_ns, .world_from_sensor = of.world_from_sensor, .calibrations = calibrations_};
}

std::vector<PixelFan> PixelOptics::footprint(std::uint32_t rays, std::span<const std::uint32_t> pixels) const {
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(rays)));
  std::vector<PixelFan> fans(rays);
  for (std::uint32_t ray = 0; ray < rays; ++ray) {
    const std::uint32_t column = ray % side, row = ray / side;
    const glm::dvec2 offset_px((column + 0.5) / side - 0.5, (row + 0.5) / side - 0.5);
    for (const std::uint32_t pixel : pixels) {
      const glm::dvec3 direction = this->direction(pixel, offset_px);
      if (direction == glm::dvec3(0)) continue;
      fans[ray].pixels.push_back(pixel);
      fans[ray].directions.push_back(direction);
      fans[ray].near_m.push_back(near_range_m(direction));
    }
  }
  return fans;
}

}  // namespace simvis
