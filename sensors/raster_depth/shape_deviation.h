// How far the meshes that a view draws lie inside of the round shapes that they stand for.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include "sensors/raster_depth/vertex_rounding.h"

namespace simvis {

/// The largest distance of a round shape from its mesh, as a function of range: an item counts at the ranges from its
/// nearest to its farthest point. A surface that is seen with an angle theta of incidence may then be nearer by this
/// distance over cos(theta), since the shape and its mesh are convex: on the beam before the mesh, the distance from
/// the plane of the triangle grows by cos(theta) per metre, and the shape ends where it exceeds the largest distance.
class ShapeDeviation {
 public:
  ShapeDeviation() = default;  ///< of a scene without round shapes
  /// Of the meshes that the view draws, see engine/geometry/round_levels.h.
  ShapeDeviation(const DrawList& list, const View& view);

  /// In metres, for a surface that is seen at this range along the ray.
  double at(double range_m) const { return any_ ? deviation_m_[VertexRounding::bin(range_m)] : 0; }

  /// No two points of a shape whose items count at this range are farther apart, in metres.
  double size_at(double range_m) const { return any_ ? size_m_[VertexRounding::bin(range_m)] : 0; }

 private:
  bool any_ = false;
  std::array<double, VertexRounding::kBins> deviation_m_{}, size_m_{};
};

/// By how much w = 1 / Z changes where a surface is nearer by `deviation_m` over the cosine of incidence. The plane of
/// the surface is m . (x, y, z) = 1, with |m| at most `steepness`: the plane's distance is 1 / |m|.
inline double change_of_inverse_depth(double w, double deviation_m, double steepness) {
  return w * deviation_m * steepness;
}

}  // namespace simvis
