// How far float32 displaces the vertices that a sensor sees.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include <simvis/draw_list.h>
#include "engine/geometry/item_extent.h"

namespace simvis {

/// An upper bound, by range, on the displacement of vertices between the exact scene and the rasteriser, in each of
/// the three clip coordinates x, y and w (clip x and y counted in the tangents of the view, so that all are metres).
///
/// A vertex p of a mesh (float32, taken as exact) goes through rows that were formed in double and rounded once to
/// float32, and is multiplied out in float32. With u = 2^-24, per coordinate:
///   5 u (|R| |p| + |t|)  one u for the rounded row, four for products and sums in any order (Higham, Accuracy and
///                    Stability of Numerical Algorithms, section 3.1), times the row's length (see depth_range.h).
///                    |t| is the distance of the mesh's origin. With E the mesh's longest edge, a triangle that is seen
///                    at range r has its corners within r + E, so that |R| |p| is at most r + E + |t|, and at most the
///                    mesh's farthest corner.
///   3 u (2 E + m)    A triangle that leaves the view is cut: a new vertex is a + s (b - a), of three roundings two of
///                    b - a and its share, no longer than E, and one of the vertex, no farther than m, the lesser of r
///                    + E and the distance of the mesh's farthest point. Three planes (a side, top or bottom, near) can
///                    cut one end of an edge, one after the other.
///   u m              1 / w, which all coordinates are then multiplied by: it moves a vertex as a change of w does.
/// The rows themselves come from products of double matrices of entries up to the scene's offset from the world's
/// origin.
///
/// A surface seen at range r belongs to a mesh whose distances reach from near to far around r: only those count. Of
/// long lists of which account is kept, those that could count are looked for when a range is first asked for.
class VertexRounding {
 public:
  VertexRounding() = default;  ///< of an empty scene
  /// The list must stay as it is until the last at().
  VertexRounding(const DrawList& list, const glm::dmat4& sensor_from_world);

  /// Metres, for a surface seen at this range along the ray.
  double at(double range_m) const;

 private:
  static constexpr int kBins = 96;
  struct Reach;
  static int bin(double range_m);
  static const std::array<double, kBins>& upper_limits();
  Reach reach_of(const DrawList& list, std::uint32_t item, const ItemExtent& extent) const;
  Reach reach_of_node(const ItemIndex& index, std::uint32_t node) const;
  void find(int bin) const;

  glm::dmat4 sensor_from_world_{1.0};
  const DrawList* list_ = nullptr;  // in which bins are yet to be found; null: all are known
  ListVersion version_;             // of it
  glm::dvec3 sensor_{0};            // in the world
  mutable std::array<bool, kBins> known_{};
  mutable std::array<double, kBins> displacement_m_{};
};

}  // namespace simvis
