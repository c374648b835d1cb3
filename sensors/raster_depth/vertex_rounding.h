// The displacement by float32 rounding of the vertices that a sensor sees.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include <simvis/draw_list.h>
#include "engine/geometry/item_extent.h"

namespace simvis {

/// An upper bound, as a function of range, on the displacement of vertices between the exact scene and the rasteriser,
/// in each of the three clip coordinates x, y and w (clip x and y are counted in the tangents of the view, so that all
/// are metres).
///
/// A vertex p of a mesh (float32, taken as exact) is transformed in float32 by rows that were computed in double and
/// rounded once to float32. With u = 2^-24, per coordinate:
///   5 u (|R| |p| + |t|)  One u is for the rounded row, four are for products and sums in any order (Higham, Accuracy
///                        and Stability of Numerical Algorithms, section 3.1), times the row's length (see
///                        depth_range.h). |t| is the distance of the mesh's origin. With E the mesh's longest edge, a
///                        triangle that is seen at range r has its corners within r + E, so |R| |p| is at most r + E +
///                        |t|, and at most the distance of the mesh's farthest corner.
///   3 u (2 E + m)    A triangle that leaves the view is clipped. A new vertex is a + s (b - a) with three roundings:
///                    two of b - a and its share, which is no longer than E, and one of the vertex, whose distance is
///                    at most m, the smaller of r + E and the distance of the mesh's farthest point. Three planes (a
///                    side, top or bottom, near) can clip one end of an edge in turn.
///   u m              All coordinates are multiplied by 1 / w: its rounding displaces a vertex as a change of w does.
/// The rows themselves are products of double matrices with entries up to the scene's offset from the world's origin.
///
/// A surface seen at range r belongs to a mesh whose distances extend from near to far around r: only those meshes
/// count. For long lists with an item index, these meshes are searched for when a range is first queried.
class VertexRounding {
 public:
  VertexRounding() = default;  ///< an empty scene
  /// The list must not change until the last call of at(), or until complete().
  VertexRounding(const DrawList& list, const glm::dmat4& sensor_from_world);

  /// Computes the bound for all ranges: from then on the list may change, and at() may be called in any thread.
  void complete();

  /// The bound in metres for a surface that is seen at this range along the ray.
  double at(double range_m) const;

  /// Ranges are counted in bins of a quarter of an octave.
  static constexpr int kBins = 96;
  static int bin(double range_m);

 private:
  struct Reach;
  static const std::array<double, kBins>& upper_limits();
  Reach reach_of(const DrawList& list, std::uint32_t item, const ItemExtent& extent) const;
  Reach reach_of_node(const ItemIndex& index, std::uint32_t node) const;
  void find(int bin) const;

  glm::dmat4 sensor_from_world_{1.0};
  const DrawList* list_ = nullptr;  // for bins that are not computed yet; null if all are known
  ListVersion version_;             // of *list_
  glm::dvec3 sensor_{0};            // position in the world
  mutable std::array<bool, kBins> known_{};
  mutable std::array<double, kBins> displacement_m_{};
};

}  // namespace simvis
