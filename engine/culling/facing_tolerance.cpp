#include "engine/culling/facing_tolerance.h"

#include <algorithm>
#include <cmath>

namespace simvis {
namespace {

// Largest difference of the axes' lengths, and largest deviation from right angles, relative to the length.
constexpr double kUneven = 1e-6;

// How far 2 A / (s E) of a triangle must exceed 0: its winding needs 6, its depth 8. See below.
constexpr double kThin = 8;

}  // namespace

// Rounding moves a corner by up to s pixels along each axis. A triangle with the sides p and q has the area A in the
// image, with 2 A = p x q. The moved triangle's 2 A differs by at most 2 s (|p|1 + |q|1) + 8 s^2 <= 4 s E + 8 s^2,
// where E is an upper bound of |.|1 of all sides. Because 2 A <= E^2, the winding does not reverse where 2 A > 6 s E.
//
// In space, let fx and fy be the focal lengths and z the depths along Z. Then 2 A >= fx fy (2 A0) D / zmax^3, where A0
// is the triangle's area and D the distance of the eye from its plane. A valid E is max(fx, fy) L W / zmin, where L is
// the longest side, W^2 = 2 + (tx + ty)^2, and tx and ty are the tangents of the view's widest angles. 2 A0 / L is the
// triangle's height h, so this condition is sufficient:
//   min(fx, fy) h D zmin / (zmax^3 W) > 6 s
//
// s is the step of the snapping grid, plus the distance by which float32 moves a vertex in space as seen from zmin. The
// latter is at most max(fx, fy) W / zmin times the distance in space. Snapping moves a vertex by half a step; the other
// half is for the rounding of the viewport transform, some 2^-23 of the viewport's width.
//
// Depth: let d be the difference between the w of the two depths, and 2 A > k 6 s E. The gradient of w on a triangle
// has |dw/du| + |dw/dv| <= d (|p|1 + |q|1) / (2 A) <= 2 d E / (k 6 s E). A covered point lies at most s, along each
// axis, outside of the triangle whose plane is evaluated, so w is off by d / (3 k) there. In float32 the relative error
// of the triangle's area is some 2^-22 E / (k 6 s), and each of the plane's three terms adds to w an error of that
// share of d. Together these errors are below another d / k while an image is no wider than 8,192 pixels and s no finer
// than 2^-8. With 8 in place of 6 that holds up to 16,384 pixels; a finer s is taken as 2^-8.
FacingTolerance::FacingTolerance(const View& view, double snap_px) {
  const Pinhole& k = view.pinhole;
  if (view.orthographic || !(k.fx_px > 0 && k.fy_px > 0)) return;
  const double tangents =
      std::max(k.cx_px, view.width_px - k.cx_px) / k.fx_px + std::max(k.cy_px, view.height_px - k.cy_px) / k.fy_px;
  const double skew = std::sqrt(2 + tangents * tangents), least = std::min(k.fx_px, k.fy_px);
  snapped_ = kThin * std::max(snap_px, 0x1p-8) * skew / least;
  rounded_ = kThin * std::max(k.fx_px, k.fy_px) * skew * skew / least;
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

double squared_thickness(const EyeInMesh& eye, const glm::vec3& p, const glm::vec3& q, const glm::vec3& r) {
  const glm::dvec3 a(p), ab = glm::dvec3(q) - a, ac = glm::dvec3(r) - a, bc = ac - ab;
  const double volume = glm::dot(glm::cross(ab, ac), eye.place - a);  // h D times the longest side
  return volume * volume / std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
}

}  // namespace simvis
