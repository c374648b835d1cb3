#include "engine/draw/oriented_box.h"

#include <cmath>
#include <limits>

namespace simvis {
namespace {

// What is left of a vector at right angles to an axis is none if it is this much shorter: rounding leaves 1e-16.
constexpr double kNoRest = 1e-12;

// Zero for a vector without length.
glm::dvec3 unit_or_zero(const glm::dvec3& v) { return glm::length(v) > 0 ? glm::normalize(v) : glm::dvec3(0); }

glm::dvec3 across(const glm::dvec3& axis, const glm::dvec3& wanted) {
  const glm::dvec3 rest = wanted - glm::dot(wanted, axis) * axis;
  return glm::length(rest) > kNoRest * glm::length(wanted) ? glm::normalize(rest) : glm::dvec3(0);
}

glm::dvec3 any_across(const glm::dvec3& axis) {
  const bool is_near_x = std::abs(axis.x) > std::abs(axis.y);
  return glm::normalize(glm::cross(axis, is_near_x ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
}

// x is that of the frame, y as near to the frame's as a right angle allows. An axis along which the frame is flattened
// stands across the others.
glm::dmat3 axes_of(const glm::dmat3& linear) {
  const glm::dvec3 x0 = unit_or_zero(linear[0]), y0 = unit_or_zero(linear[1]), z0 = unit_or_zero(linear[2]);
  const glm::dvec3 none(0), longer = y0 != none ? y0 : z0;
  const bool has_plane = y0 != none && across(y0, z0) != none;
  glm::dvec3 x = x0 != none ? x0 : has_plane ? glm::normalize(glm::cross(y0, z0)) : none;
  if (x == none) x = longer != none ? any_across(longer) : glm::dvec3(1, 0, 0);
  glm::dvec3 y = across(x, linear[1]);
  if (y == none) y = across(x, glm::cross(z0, x));
  if (y == none) y = any_across(x);
  return {x, y, glm::cross(x, y)};
}

}  // namespace

OrientedBox oriented_box(const glm::dvec3& low_corner, const glm::dvec3& high_corner,
                         const glm::dmat4& frame_from_box) {
  const glm::dmat3 linear(frame_from_box);
  const glm::dmat3 axes = axes_of(linear);
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 at((corner & 1) != 0 ? high_corner.x : low_corner.x,
                        (corner & 2) != 0 ? high_corner.y : low_corner.y,
                        (corner & 4) != 0 ? high_corner.z : low_corner.z);
    const glm::dvec3 turned = glm::transpose(axes) * (linear * at);
    low = glm::min(low, turned);
    high = glm::max(high, turned);
  }
  OrientedBox box{.centre_m = axes * ((low + high) / 2.0) + glm::dvec3(frame_from_box[3]),
                  .size_m = high - low,
                  .orientation = glm::normalize(glm::quat_cast(axes))};
  if (box.orientation.w < 0) box.orientation = -box.orientation;
  return box;
}

}  // namespace simvis
