#include "engine/culling/facing_tolerance.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

// By how much axes may differ in length, and be off a right angle, relative to their length.
constexpr double kUneven = 1e-6;

}  // namespace

// Rounding moves a corner by up to s pixels along each axis. A triangle with the sides p and q has the area 2 A = p x q
// in the picture; moved, it differs by at most 2 s (|p|1 + |q|1) + 8 s^2 <= 4 s E + 8 s^2, where E is no less than any
// side's |.|1. As 2 A <= E^2, nothing turns over where 2 A > 6 s E.
//
// In space, with fx and fy the focal lengths and z the depths: 2 A >= fx fy (2 A0) D / zmax^3, where A0 is the area and
// D how far the eye lies from the plane; and max(fx, fy) L W / zmin will do as E, where L is the longest side and
// W^2 = 2 + (tx + ty)^2, tx and ty the tangents of the view's widest angles. 2 A0 / L is the triangle's height h, so
//   min(fx, fy) h D zmin / (zmax^3 W) > 6 s
// is enough.
//
// s is the grid's, and what float32 moves a vertex by in space, seen from zmin: at most max(fx, fy) W / zmin times
// that. The grid moves by half a step; the other half is for the rounding of the viewport, some 2^-23 of its width.
//
// Depth: with d what lies between the two w, and 2 A > k 6 s E: the gradient of w on a triangle has |dw/du| + |dw/dv|
// <= d (|p|1 + |q|1) / (2 A) <= 2 d E / (k 6 s E). What is covered lies at most s, along each axis, outside of the
// triangle whose plane is taken, so w is off by d / (3 k) there. In float32 the triangle's area is off by some
// 2^-22 E / (k 6 s) of itself, and w by as much of d again for each of the plane's three terms: together less than
// another d / k while a picture is no wider than 16,384 pixels and s no finer than 2^-8.
FacingTolerance::FacingTolerance(const View& view, double snap_px) {
  const Pinhole& k = view.pinhole;
  if (view.orthographic || !(k.fx_px > 0 && k.fy_px > 0)) return;
  const double tangents =
      std::max(k.cx_px, view.width_px - k.cx_px) / k.fx_px + std::max(k.cy_px, view.height_px - k.cy_px) / k.fy_px;
  const double skew = std::sqrt(2 + tangents * tangents), least = std::min(k.fx_px, k.fy_px);
  snapped_ = 6 * snap_px * skew / least;
  rounded_ = 6 * std::max(k.fx_px, k.fy_px) * skew * skew / least;
}

std::optional<EyeInMesh> eye_in(const glm::dmat4& view_from_mesh) {
  const glm::dmat3 axes(view_from_mesh);
  const double square = glm::dot(axes[0], axes[0]), uneven = kUneven * square;
  const bool even = square > 0 && std::abs(glm::dot(axes[1], axes[1]) - square) <= uneven &&
                    std::abs(glm::dot(axes[2], axes[2]) - square) <= uneven &&
                    std::abs(glm::dot(axes[0], axes[1])) <= uneven && std::abs(glm::dot(axes[1], axes[2])) <= uneven &&
                    std::abs(glm::dot(axes[2], axes[0])) <= uneven;
  if (!even) return {};
  return EyeInMesh{glm::transpose(axes) * -glm::dvec3(view_from_mesh[3]) / square, std::sqrt(square)};
}

}  // namespace simvis
