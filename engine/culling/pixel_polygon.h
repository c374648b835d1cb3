// Flat convex shapes as the pixels of a view see them, cut where the device cuts them; and how far its rounding lets
// one be certain of them.
//
// With w = 1 / z, affine in pixels on a plane, and w smaller where it is farther away:
//   place   A vertex is displaced by float32 and by the rasteriser's grid. Of shapes whose corners may be displaced by
//           more than kDisplaced_px nothing is said. Others are sure to fill what lies a whole pixel within their
//           edges.
//   depth   The w of a triangle at a pixel is that of its plane but for what shifts by half a pixel and some roundings
//           make of it: see plane_rounding.h in sensors/, whose terms are all in kShift_px, kRounding and kSlope.
//           Of triangles thinner than a pixel, whose slopes float32 may turn, nothing is said.
//   cuts    Where a side of the viewport cuts a triangle, the device puts others in its place, between any of the
//           corners that are left. What is said of depth holds of each of those. Where a corner lies so near to a side
//           that it may or may not be cut off, nothing is said.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include <simvis/frame_plan.h>

namespace simvis {

/// What a corner may be displaced by at the most, so that the rest holds.
inline constexpr double kDisplaced_px = 0.125;
/// A corner that lies so far from a side of the viewport is cut off, or it is not, whatever rounding makes of it.
inline constexpr double kSide_px = 1;
/// By how much less far than its edges a shape is taken to reach.
inline constexpr double kInwards_px = 1;
/// What w is taken to be off by: of its gradient, of itself, and of its range over the triangle times the share of the
/// box around it that it does not fill.
inline constexpr double kShift_px = 0.5, kRounding = 1e-4, kSlope = 50 * 0x1p-24;

/// A corner at pixel (u, v).
struct PixelCorner {
  double u = 0, v = 0, w = 0;
};

/// Where (u z, v z, z) is seen.
inline PixelCorner in_pixels(const glm::dvec3& point) {
  const double w = 1 / point.z;
  return {point.x * w, point.y * w, w};
}

inline bool crosses(const PixelCorner& a, const PixelCorner& b, double v) { return (a.v < v) != (b.v < v); }

/// Where the edge from a to b crosses the row v, if it does.
inline PixelCorner crossing(const PixelCorner& a, const PixelCorner& b, double v) {
  const double share = (v - a.v) / (b.v - a.v);
  return {a.u + share * (b.u - a.u), v, a.w + share * (b.w - a.w)};
}

/// What lies between two edges in a row; first > end where there is nothing.
struct PixelSpan {
  double first = 0, end = 0;
};

struct PixelPolygon {
  static constexpr int kMaxCorners = 9;  ///< four, cut by five planes
  PixelCorner corners[kMaxCorners];
  int count = 0;

  std::span<const PixelCorner> all() const { return std::span(corners).first(static_cast<std::size_t>(count)); }
  PixelSpan at_row(double v) const;
};

/// How w runs on a polygon.
struct PixelSlant {
  bool certain = false;
  PixelCorner anchor{};    ///< a corner
  double du = 0, dv = 0;   ///< per pixel
  double gradient = 0;     ///< |du| + |dv|
  double uncertain_w = 0;  ///< what w may be off by where the device draws it

  /// w there, on its plane.
  double at(const PixelCorner& p) const { return anchor.w + du * (p.u - anchor.u) + dv * (p.v - anchor.v); }
};

/// Of all triangles between the polygon's corners that have one of its sides.
PixelSlant slant_of(const PixelPolygon& polygon);

/// The sides of a view's viewport. Points are (u z, v z, z), in pixels times metres and metres.
class PixelSides {
 public:
  PixelSides() = default;
  explicit PixelSides(const View& view);

  /// Nearer points, of what is displaced by up to `slack_m` in any direction, are displaced too far in the picture.
  double min_z_m(double slack_m) const;

  /// The shape, if no side, however rounded, cuts it.
  bool keep(std::span<const glm::dvec3> corners, double min_z_m, PixelPolygon& whole) const;
  /// What is left of a triangle or quadrangle that sides cut, were they moved outwards by so much. False if that is
  /// nothing, or if it cannot be told.
  bool cut(std::span<const glm::dvec3> corners, double outwards_px, double min_z_m, PixelPolygon& left) const;

 private:
  bool keeps(const glm::dvec3& p, double min_z_m) const;
  bool may_cut(const glm::dvec3& p, double min_z_m) const;

  double width_ = 0, height_ = 0, guard_ = 0, near_m_ = 0, focal_px_ = 0;
};

}  // namespace simvis
