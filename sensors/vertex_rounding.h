// How far float32 displaces the vertices that a sensor sees.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "engine/draw_list.h"

namespace simvis {

/// An upper bound, by range, on the displacement of vertices between the exact scene and the rasteriser.
///
/// A vertex p of a mesh (float32, taken as exact) goes through a 3 x 4 matrix that was formed in double and rounded
/// once to float32, and is multiplied out in float32: per component at most 5 u (|R| |p| + |t|) with u = 2^-24, one u
/// for the rounded matrix and four for products and sums in any order (Higham, Accuracy and Stability of Numerical
/// Algorithms, section 3.1). A triangle that leaves the view is cut: a new vertex lies between two old ones and costs
/// two roundings of their size; up to three planes (a side, top or bottom, near) cut at one corner. Hence 11 u, times
/// sqrt(3) for the vector of three components, times sqrt(2) because a row of a 90 degree view mixes two unit axes.
/// |R| |p| is bounded by the mesh's farthest corner, |t| is its origin's distance.
/// The matrix itself is a product of two double matrices of entries up to the scene's offset from the world's origin.
///
/// A surface seen at range r belongs to a mesh whose distances reach from near to far around r: only those count.
class VertexRounding {
 public:
  VertexRounding() = default;  ///< of an empty scene
  VertexRounding(const DrawList& list, const glm::dmat4& sensor_from_world);

  /// Metres, for a surface seen at this range along the ray.
  double at(double range_m) const;

 private:
  static constexpr int kBins = 96;
  static int bin(double range_m);
  std::array<double, kBins> displacement_m_{};
};

}  // namespace simvis
