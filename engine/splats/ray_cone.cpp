#include "engine/splats/ray_cone.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

// Above the rounding of angles in double, and of lengths of axes in float32.
constexpr double kAngleMargin = 1e-12, kMargin = 1e-6;

RayCone cone_of_angle(const glm::dvec3& axis, double angle_rad) {
  constexpr double kWidest_rad = 1.5;
  angle_rad += kAngleMargin;
  if (angle_rad > kWidest_rad) return {.axis = axis, .is_wide = true};
  return {.axis = axis, .cosine = std::cos(angle_rad), .sine = std::sin(angle_rad)};
}

// Also exact for small angles.
double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// The normal points to the splat and away from a cone that the plane through the origin touches.
bool separates(const glm::dvec3& normal, const SeenSplat& splat) {
  return glm::dot(normal, splat.center_m) > (1 + kMargin) * glm::length(normal * glm::dmat3(splat.half_axes_m));
}

// Whether the plane that touches the cone on the side of `towards`, any vector, separates it from the splat.
bool separates_towards(const glm::dvec3& towards, const RayCone& cone, const SeenSplat& splat) {
  const glm::dvec3 across = towards - glm::dot(towards, cone.axis) * cone.axis;
  const double length = glm::length(across);
  return length > 0 && separates(across * (cone.cosine / length) - cone.axis * cone.sine, splat);
}

// Whether a point lies in the cone: most splats of a wide one do, so that no plane needs to be tried.
bool contains(const RayCone& cone, const glm::dvec3& point) {
  const double along = glm::dot(point, cone.axis);
  return along > 0 && along * along >= cone.cosine * cone.cosine * glm::dot(point, point);
}

}  // namespace

RayCone cone_of(std::span<const glm::dvec3> directions) {
  glm::dvec3 sum(0);
  for (const glm::dvec3& direction : directions) sum += direction;
  const double length = glm::length(sum);
  if (std::ranges::all_of(directions, [](const glm::dvec3& direction) { return direction == glm::dvec3(0); }))
    return {};
  if (length == 0) return {.axis = {0, 0, 1}, .is_wide = true};
  const glm::dvec3 axis = sum / length;
  double angle_rad = 0;
  for (const glm::dvec3& direction : directions) {
    if (direction != glm::dvec3(0)) angle_rad = std::max(angle_rad, angle_between(axis, direction));
  }
  return cone_of_angle(axis, angle_rad);
}

RayCone cone_around(std::span<const RayCone> cones) {
  glm::dvec3 sum(0);
  bool any_wide = false;
  for (const RayCone& cone : cones) {
    sum += cone.axis;
    any_wide |= cone.is_wide;
  }
  const double length = glm::length(sum);
  if (std::ranges::all_of(cones, &RayCone::empty)) return {};
  if (any_wide || length == 0) return {.axis = {0, 0, 1}, .is_wide = true};
  const glm::dvec3 axis = sum / length;
  double angle_rad = 0;
  for (const RayCone& cone : cones) {
    if (cone.empty()) continue;
    angle_rad = std::max(angle_rad, angle_between(axis, cone.axis) + std::atan2(cone.sine, cone.cosine));
  }
  return cone_of_angle(axis, angle_rad);
}

RayCone cone_of(const SeenSplat& splat) {
  const double distance = glm::length(splat.center_m);
  const double radius = glm::length(glm::dvec3(splat.half_axes_m[0])) * (1 + kMargin);
  if (!(radius < distance)) return {.axis = {0, 0, 1}, .is_wide = true};
  return cone_of_angle(splat.center_m / distance, std::asin(radius / distance));
}

bool may_overlap(const RayCone& a, const RayCone& b) {
  if (a.is_wide || b.is_wide) return true;
  return glm::dot(a.axis, b.axis) >= a.cosine * b.cosine - a.sine * b.sine - kAngleMargin;
}

// A splat and a cone are convex: if they are apart, a plane through the cone's tip separates them. Two planes are
// tried: the one towards the splat's centre, which finds round splats, and the one across the plane of the line of
// sight and the longest axis, which finds long ones.
bool may_meet(const RayCone& cone, const SeenSplat& splat) {
  if (cone.is_wide || contains(cone, splat.center_m)) return true;
  if (separates(-cone.axis, splat) || separates_towards(splat.center_m, cone, splat)) return false;
  const glm::dvec3 beside = glm::cross(splat.center_m, glm::dvec3(splat.half_axes_m[0]));
  return !separates_towards(glm::dot(beside, cone.axis) > 0 ? -beside : beside, cone, splat);
}

}  // namespace simvis
