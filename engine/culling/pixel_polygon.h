// Flat convex polygons in pixel coordinates, clipped as the device clips them, with bounds for the device's rounding.
//
// w = 1 / z is affine in pixel coordinates on a plane, and smaller at larger depth along Z.
//   place     Float32 and the rasteriser's snapping displace a vertex. A shape whose corners may be displaced by more
//             than kDisplaced_px, in a view of at most 45 degrees to each side, is not certain.
//   depth     The w of a triangle at a pixel is that of its plane, except for shifts by half a pixel and for some
//             roundings: see engine/geometry/plane_rounding.h. kShift_px, kRounding and kSlope include all terms given
//             there. A triangle thinner than a pixel is not certain, because float32 may turn its slope.
//   clipping  Where a side of the viewport clips a triangle, the device replaces it by triangles between any of the
//             remaining corners. The bound of the depth holds for each of those. If a corner lies so near to a side
//             that it may or may not be clipped, the shape is not certain.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include <simvis/frame_plan.h>

namespace simvis {

/// The largest displacement of a corner for which the bounds of this file hold.
inline constexpr double kDisplaced_px = 0.125;
/// A corner at this distance from a side of the viewport is certainly clipped or certainly kept, whatever the rounding.
inline constexpr double kSide_px = 1;
/// The bound of the error of w has three terms: kShift_px times the gradient of w; kRounding times w; and kSlope times
/// the range of w over the triangle, times the area of the box around the triangle over twice the triangle's own area.
inline constexpr double kShift_px = 0.5, kRounding = 1e-4, kSlope = 50 * 0x1p-24;

/// A corner at pixel (u, v).
struct PixelCorner {
  double u = 0, v = 0, w = 0;
};

/// The pixel coordinates of the point (u z, v z, z).
inline PixelCorner in_pixels(const glm::dvec3& point) {
  const double w = 1 / point.z;
  return {point.x * w, point.y * w, w};
}

inline bool crosses(const PixelCorner& a, const PixelCorner& b, double v) { return (a.v < v) != (b.v < v); }

/// Where the edge from a to b crosses the row v. Requires crosses(a, b, v).
inline PixelCorner crossing(const PixelCorner& a, const PixelCorner& b, double v) {
  const double share = (v - a.v) / (b.v - a.v);
  return {a.u + share * (b.u - a.u), v, a.w + share * (b.w - a.w)};
}

/// The part of a row between two edges; first > end if it is empty.
struct PixelSpan {
  double first = 0, end = 0;
};

struct PixelPolygon {
  static constexpr int kMaxCorners = 9;  ///< four corners, clipped by five planes
  PixelCorner corners[kMaxCorners];
  int count = 0;

  std::span<const PixelCorner> all() const { return std::span(corners).first(static_cast<std::size_t>(count)); }
  PixelSpan at_row(double v) const;
};

/// The gradient of w on a polygon, and a bound of its error.
struct PixelSlant {
  bool certain = false;
  PixelCorner anchor{};    ///< a corner of the polygon
  double du = 0, dv = 0;   ///< change of w per pixel
  double gradient = 0;     ///< |du| + |dv|
  double uncertain_w = 0;  ///< bound of the error of w where the device draws the polygon

  /// w at `p` on the polygon's plane.
  double at(const PixelCorner& p) const { return anchor.w + du * (p.u - anchor.u) + dv * (p.v - anchor.v); }
};

/// Bounds that hold for every triangle of the polygon's corners that has one of the polygon's sides. They are not
/// `certain` if one of these triangles is thinner than a pixel.
PixelSlant slant_of(const PixelPolygon& polygon);

/// Clips shapes at the sides of a view's viewport. Points are (u z, v z, z), in pixels times metres and metres.
class PixelSides {
 public:
  PixelSides() = default;
  explicit PixelSides(const View& view);

  /// The smallest depth along Z, in metres, for points that are displaced by up to `slack_m` in any direction: nearer
  /// points may be displaced by more than kDisplaced_px in the image.
  double min_z_m(double slack_m) const;

  /// Converts the shape to pixels. Returns false if a side, with any rounding, may clip it.
  bool keep(std::span<const glm::dvec3> corners, double min_z_m, PixelPolygon& whole) const;
  /// Clips a triangle or quadrangle at the sides, which are moved outwards by `outwards_px`. Returns false if nothing
  /// is left, or if the result depends on rounding.
  bool cut(std::span<const glm::dvec3> corners, double outwards_px, double min_z_m, PixelPolygon& left) const;

 private:
  bool keeps(const glm::dvec3& p, double min_z_m) const;
  bool may_cut(const glm::dvec3& p, double min_z_m) const;

  double width_ = 0, height_ = 0, guard_ = 0, near_m_ = 0, focal_px_ = 0;
};

}  // namespace simvis
