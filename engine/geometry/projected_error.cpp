#include "engine/geometry/projected_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace simvis {
namespace {

// The largest factor by which a transform lengthens a vector, or more: the square root of the largest sum of a row of
// M^T M (Gershgorin). It is exact for scaled axes at right angles.
double largest_stretch(const glm::dmat4& transform) {
  const glm::dmat3 axes(transform);
  const glm::dmat3 square = glm::transpose(axes) * axes;
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    largest = std::max(largest, std::abs(square[i].x) + std::abs(square[i].y) + std::abs(square[i].z));
  }
  return std::sqrt(largest);
}

double nearest_depth(const ViewProjection& projection, const WorldBox& box) {
  const glm::dvec3 center = glm::dvec3(projection.view_from_world * glm::dvec4(box.center, 1));
  double reach = 0;
  for (const glm::dvec3& axis : box.axis) reach += std::abs(glm::dot(projection.forward_world, axis));
  return center.z - reach;
}

}  // namespace

// Let p be within the view, with |x/z| <= tx and |y/z| <= ty, and q = p + d. Along x, q appears at
// x/z + (dx - (x/z) dz) / qz, and alike along y. So the difference is f / qz times a vector that is no longer than
// |d| sqrt(1 + tx^2 + ty^2), the norm of the matrix (1 0 -tx; 0 1 -ty); and qz is at least the nearest depth of the box
// less |d|.
ProjectedError::ProjectedError(const View& view, const ViewProjection& projection, const WorldBox& box,
                               const glm::dmat4& world_from_mesh)
    : orthographic_(view.orthographic),
      near_m_(view.near_m),
      focal_px_(std::max(std::abs(view.pinhole.fx_px), std::abs(view.pinhole.fy_px))),
      stretch_(largest_stretch(world_from_mesh)),
      nearest_m_(nearest_depth(projection, box)) {
  if (orthographic_) return;
  const Pinhole& k = view.pinhole;
  const double tx = std::max(k.cx_px, view.width_px - k.cx_px) / k.fx_px,
               ty = std::max(k.cy_px, view.height_px - k.cy_px) / k.fy_px;
  focal_px_ *= std::sqrt(1 + tx * tx + ty * ty);
}

double ProjectedError::px(double error_m) const {
  const double moved_m = error_m * stretch_;
  if (orthographic_) return focal_px_ * moved_m;
  const double nearest_m = nearest_m_ - moved_m;
  if (!(nearest_m > near_m_)) return std::numeric_limits<double>::infinity();
  return focal_px_ * moved_m / nearest_m;
}

}  // namespace simvis
