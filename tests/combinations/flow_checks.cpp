// Where the points of pixels are in another frame, and whether that frame shows them.
#include <algorithm>
#include <cmath>

#include "tests/combinations/pixel_rays.h"

namespace simvis::combined {
namespace {

// Whether points move apart in the image up to this tangent of the angle from the axis, in all directions, by a slope
// of at least 0.01. The radial part has the slope below. The tangential part changes it by up to 6 |p| times the
// tangent.
bool is_before_fold(const SensorDesc& desc, Real tangent) {
  constexpr int kSteps = 256;
  const Real tangential = 6 * std::hypot(Real(desc.lens_k[3]), Real(desc.lens_k[4]));
  for (int i = 1; i <= kSteps; ++i) {
    const Real r2 = tangent * tangent * i * i / (kSteps * kSteps);
    const Real slope = 1 + r2 * (3 * desc.lens_k[0] + r2 * (5 * desc.lens_k[1] + r2 * 7 * desc.lens_k[2]));
    if (slope - tangential * std::sqrt(r2) < Real(0.01L)) return false;
  }
  return true;
}

Frame motion(const ExactWorld& world, const ExactHit& hit, Real from, Real to) {
  const auto body = static_cast<std::size_t>(hit.body);
  return world.body(body, to) * inverse(world.body(body, from));
}

}  // namespace

bool shows(const SensorDesc& desc, const Vector& view) {
  if (view.z < Real(0.2L) * glm::length(view)) return false;
  return desc.lens != "brown_conrady" || is_before_fold(desc, std::hypot(view.x, view.y) / view.z);
}

FollowedPoint follow(const ViewRays& rays, const PixelRay& pixel, Real range_m, Real from, Real to) {
  const ExactWorld& world = rays.with().world;
  const Frame eye = rays.eye(from), other = rays.eye(to);
  FollowedPoint point;
  point.from = point.to = eye.turn * ViewRays::sensor_of_optical(pixel.ray);
  Vector towards = point.to;
  if (pixel.surface.body >= 0) {
    const Frame moved = motion(world, pixel.surface, from, to);
    point.from = range_m * point.from + eye.at;
    point.to = moved.turn * point.from + moved.at;
    towards = point.to - other.at;
  }
  const Vector view = ViewRays::optical_of_sensor(glm::transpose(other.turn) * towards);
  point.at_px = pixel_of_ray(rays.with().desc(), view);
  point.is_defined = shows(rays.with().desc(), view);
  return point;
}

std::optional<bool> is_hidden(const ViewRays& rays, const PixelRay& pixel, Real from, Real to) {
  constexpr Real kBorder_px = 1e-6L;  // far above the rounding of places
  const Comparison& with = rays.with();
  const SensorDesc& desc = with.desc();
  const bool sky = pixel.surface.body < 0;
  const FollowedPoint point = follow(rays, pixel, pixel.surface.range_m, from, to);
  if (!point.is_defined) return std::nullopt;
  if (!point.at_px) return true;
  const auto beyond = [&](Real room_px) {
    const auto& at = *point.at_px;
    return at.x < -room_px || at.y < -room_px || at.x > desc.width_px + room_px || at.y > desc.height_px + room_px;
  };
  if (beyond(kBorder_px)) return true;
  if (beyond(-kBorder_px)) return std::nullopt;
  const Frame eye = rays.eye(to);
  const Vector way = sky ? point.to : point.to - eye.at;
  const Real range = sky ? kInfinite : glm::length(way);
  const Vector direction = sky ? way : way / range;
  const Vector ray = ViewRays::optical_of_sensor(glm::transpose(eye.turn) * direction);
  const Real near = rays.near_m(ray);
  if (std::abs(range - near) < near * Real(1e-9L)) return std::nullopt;
  if (range <= near) return true;
  Vector normal(0);
  if (!sky) normal = motion(with.world, pixel.surface, from, to).turn * pixel.surface.normal;
  const Real facing = glm::dot(normal, direction), cosine = std::max(std::abs(facing), Real(1e-6L));
  const bool shows_back = !sky && facing > 0 && with.body(pixel.surface).single_sided;
  // Of both ranges, and of a direction that is wrong by the spread below.
  const Real rounding = sky ? Real(0)
                            : 8 * (with.rounding_m(pixel.surface) +
                                   (with.world.pose_rounding_m(with.sensor) + kDoubles * range) / cosine);
  const auto outcome = [&](const Vector& towards, Real wrong_m) -> std::optional<bool> {
    const ExactHit first = first_of(with.scene, rays.surfaces(eye.at, towards, to), rays.seen(), near);
    if (sky) return first.body >= 0;
    const bool here = std::abs(first.range_m - range) <= wrong_m;
    if (here && first.body == pixel.surface.body) return false;
    if (here) return std::nullopt;  // another body at the same place
    if (first.range_m < range || shows_back) return true;
    return std::nullopt;  // beside the edge of the surface
  };
  const std::optional<bool> hidden = outcome(direction, rounding);
  const Real spread = 64 * (with.world.pose_rounding_m(with.sensor) / std::min(range, Real(1)) + kDoubles);
  const Vector across =
      glm::normalize(glm::cross(direction, std::abs(direction.x) < Real(0.5L) ? Vector(1, 0, 0) : Vector(0, 1, 0)));
  const Vector up = glm::cross(direction, across);
  bool is_certain = hidden.has_value();
  around(spread, [&](Real dx, Real dy) {
    if (!is_certain) return;
    const Real wrong_m = sky ? Real(0) : rounding + 2 * spread * range / cosine;
    is_certain = outcome(glm::normalize(direction + dx * across + dy * up), wrong_m) == hidden;
  });
  return is_certain ? hidden : std::nullopt;
}

}  // namespace simvis::combined
