#include "engine/culling/pixel_polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/assert.h"
#include "engine/geometry/view_projection.h"

namespace simvis {
namespace {

// Rounding may turn the slope of a triangle that is at most this thin.
constexpr double kThin_px = 1;

}  // namespace

PixelSpan PixelPolygon::at_row(double v) const {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int i = 0; i < count; ++i) {
    const PixelCorner &p = corners[i], &q = corners[(i + 1) % count];
    if (!crosses(p, q, v)) continue;
    const double u = crossing(p, q, v).u;
    low = std::min(low, u);
    high = std::max(high, u);
  }
  return {low, high};
}

PixelSlant slant_of(const PixelPolygon& polygon) {
  PixelSlant slant{.certain = true};
  double largest = 0, unfilled = 0;
  const int count = polygon.count;
  for (int i = 0; i < count; ++i) {
    const PixelCorner &a = polygon.corners[i], &b = polygon.corners[(i + 1) % count];
    for (int k = 2; k < count; ++k) {
      const PixelCorner& c = polygon.corners[(i + k) % count];
      const double du1 = b.u - a.u, dv1 = b.v - a.v, du2 = c.u - a.u, dv2 = c.v - a.v;
      const double signed_area = du1 * dv2 - du2 * dv1, area = std::abs(signed_area);
      const double box_u = std::max({a.u, b.u, c.u}) - std::min({a.u, b.u, c.u});
      const double box_v = std::max({a.v, b.v, c.v}) - std::min({a.v, b.v, c.v});
      // No side is longer than the sum of the box's sides.
      if (!(area > kThin_px * (box_u + box_v))) return {};
      unfilled = std::max(unfilled, box_u * box_v / area);
      if (area <= largest) continue;
      largest = area;
      const double dw1 = b.w - a.w, dw2 = c.w - a.w;
      slant.anchor = a;
      slant.du = (dw1 * dv2 - dw2 * dv1) / signed_area;
      slant.dv = (dw2 * du1 - dw1 * du2) / signed_area;
    }
    if (count == 3) break;
  }
  slant.gradient = std::abs(slant.du) + std::abs(slant.dv);
  const auto [lowest, highest] = std::ranges::minmax(polygon.all(), {}, &PixelCorner::w);
  slant.uncertain_w = kShift_px * slant.gradient + kRounding * highest.w + kSlope * unfilled * (highest.w - lowest.w);
  return slant;
}

PixelSides::PixelSides(const View& view)
    : width_(view.width_px),
      height_(view.height_px),
      guard_(guard_rows(view)),
      near_m_(view.near_m),
      focal_px_(std::max(std::abs(view.pinhole.fx_px), std::abs(view.pinhole.fy_px))) {}

// The factor 2 is for displacements across the view and along z. In a view of at most 45 degrees to each side, a
// displacement along z moves the image of a point no farther than one across.
double PixelSides::min_z_m(double slack_m) const { return std::max(near_m_, 2 * focal_px_ * slack_m / kDisplaced_px); }

// Returns whether no side, with any rounding, clips the point.
bool PixelSides::keeps(const glm::dvec3& p, double min_z_m) const {
  return p.z > min_z_m && p.x > kSide_px * p.z && p.x < (width_ - kSide_px) * p.z && p.y > (kSide_px - guard_) * p.z &&
         p.y < (height_ + guard_ - kSide_px) * p.z;
}

bool PixelSides::keep(std::span<const glm::dvec3> corners, double min_z_m, PixelPolygon& whole) const {
  if (!std::ranges::all_of(corners, [&](const glm::dvec3& p) { return keeps(p, min_z_m); })) return false;
  std::ranges::transform(corners, whole.corners, in_pixels);
  whole.count = static_cast<int>(corners.size());
  return true;
}

// Returns whether the point lies so near to a side that rounding decides whether it is clipped.
bool PixelSides::may_cut(const glm::dvec3& p, double min_z_m) const {
  const double near = kSide_px * std::max(p.z, min_z_m);
  return std::abs(p.x) < near || std::abs(p.x - width_ * p.z) < near || std::abs(p.y + guard_ * p.z) < near ||
         std::abs(p.y - (height_ + guard_) * p.z) < near;
}

bool PixelSides::cut(std::span<const glm::dvec3> whole, double outwards_px, double min_z_m,
                     PixelPolygon& polygon) const {
  constexpr int kMax = PixelPolygon::kMaxCorners;
  SIMVIS_ASSERT(whole.size() <= kMax - 5);
  if (std::ranges::any_of(whole, [&](const glm::dvec3& p) { return may_cut(p, min_z_m); })) return false;
  glm::dvec3 corners[kMax], left[kMax];
  std::ranges::copy(whole, corners);
  auto count = static_cast<int>(whole.size());
  const auto cut_by = [&](const auto& inwards) {
    int kept = 0;
    for (int i = 0; i < count; ++i) {
      const glm::dvec3 &p = corners[i], &q = corners[(i + 1) % count];
      const double at_p = inwards(p), at_q = inwards(q);
      if (at_p >= 0) left[kept++] = p;
      if ((at_p >= 0) != (at_q >= 0)) left[kept++] = p + (at_p / (at_p - at_q)) * (q - p);
    }
    std::copy(left, left + kept, corners);
    count = kept;
  };
  cut_by([&](const glm::dvec3& p) { return p.z - near_m_; });
  cut_by([&](const glm::dvec3& p) { return p.x + outwards_px * p.z; });
  cut_by([&](const glm::dvec3& p) { return (width_ + outwards_px) * p.z - p.x; });
  cut_by([&](const glm::dvec3& p) { return p.y + (guard_ + outwards_px) * p.z; });
  cut_by([&](const glm::dvec3& p) { return (height_ + guard_ + outwards_px) * p.z - p.y; });
  polygon.count = count;
  for (int i = 0; i < count; ++i) {
    if (!(corners[i].z > min_z_m)) return false;
    polygon.corners[i] = in_pixels(corners[i]);
  }
  return count >= 3;
}

}  // namespace simvis
