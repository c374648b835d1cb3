#include "tests/combinations/pixel_rays.h"

#include <algorithm>
#include <cmath>

namespace simvis::combined {
namespace {

// Whether the image of a lens is drawn on the faces of a cube: a view along the optical axis would lack rays, or have
// more than four times its pixels.
bool is_on_cube(const SensorDesc& desc) {
  if (desc.lens == "none") return false;
  Vector low(kInfinite), high(-kInfinite);
  for (int y = 0; y < desc.height_px; ++y) {
    for (int x = 0; x < desc.width_px; ++x) {
      const std::optional<Vector> ray = ray_of_pixel(desc, Real(x) + Real(0.5), Real(y) + Real(0.5));
      if (!ray) continue;
      if (ray->z <= 0) return true;
      low = glm::min(low, *ray / ray->z);
      high = glm::max(high, *ray / ray->z);
    }
  }
  const Vector size_px = (high - low) * Real(focal_px(desc));
  return size_px.x * size_px.y > 4 * Real(desc.width_px) * Real(desc.height_px);
}

}  // namespace

ViewRays::ViewRays(const Comparison& comparison, Real right_m)
    : with_(comparison), right_m_(right_m), is_on_cube_(is_on_cube(comparison.desc())) {}

bool ViewRays::is_cast() const {
  const SensorDesc& desc = with_.desc();
  return desc.lens != "none" || desc.layer != "visible" || has_word(desc.outputs, "normal") ||
         has_word(desc.outputs, "layers") || has_word(desc.outputs, "occlusion");
}

// Drawn edges are snapped to a grid; those of rays are decided but for rounding.
Real ViewRays::reach_px(Real range_m) const {
  const Real range = std::isfinite(range_m) ? range_m : Real(1);
  const Real rounding_px = 8 * focal_px(with_.desc()) * (with_.world.pose_rounding_m(with_.sensor) / range + kDoubles);
  return is_cast() ? rounding_px : kSnapping_px + rounding_px;
}

Real ViewRays::share_of_row(int row) const {
  const SensorDesc& desc = with_.desc();
  return with_.share_of_age(desc.row_time_s * (desc.height_px - 1 - std::clamp(row, 0, desc.height_px - 1)));
}

Seen ViewRays::seen() const {
  const std::string& layer = with_.desc().layer;
  return layer == "first" ? Seen::any : layer == "visible" ? Seen::half : Seen::opaque;
}

Real ViewRays::near_m(const Vector& ray) const {
  const Real near = with_.desc().near_m;
  if (!is_on_cube_ && ray.z > 0) return near / ray.z;
  return near / std::max({std::abs(ray.x), std::abs(ray.y), std::abs(ray.z)});
}

std::vector<ExactHit> ViewRays::surfaces(const Vector& origin, const Vector& direction, Real share) const {
  std::vector<ExactHit> hits = with_.world.hits(origin, direction, share);
  std::erase_if(hits, [&](const ExactHit& hit) { return hit.from_behind && with_.body(hit).single_sided; });
  return hits;
}

PixelRay ViewRays::pixel(Real x_px, Real y_px, Real share) const {
  PixelRay result;
  const std::optional<Vector> ray = ray_of_pixel(with_.desc(), x_px, y_px);
  if (!ray) return result;
  result.sees = true;
  result.ray = *ray;
  const Frame sensor = eye(share);
  result.hits = surfaces(sensor.at, sensor.turn * sensor_of_optical(*ray), share);
  result.surface = result.hit = first_of(with_.scene, result.hits, seen(), near_m(*ray));
  see_splats(result, sensor, share);
  return result;
}

void ViewRays::see_splats(PixelRay& pixel, const Frame& sensor, Real share) const {
  const auto splats = with_.world.splats(sensor.at, sensor.turn * sensor_of_optical(pixel.ray), share);
  const HalfOfSplats half = half_of(splats, near_m(pixel.ray), pixel.surface.range_m);
  pixel.is_doubtful = pixel.is_doubtful || half.is_doubtful;
  if (half.hit.body >= 0) pixel.hit = half.hit;
}

}  // namespace simvis::combined
