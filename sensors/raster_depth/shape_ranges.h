// What rendered ranges leave out of round shapes: a renderer draws a polyhedron, and the true range is that of the
// exact shape (see <simvis/exact_surface.h>).
//
// Let r be a rendered range with the bound b of the drawn triangles, and t the first range at which the beam meets an
// exact shape, cast with the bound e. The drawn polyhedron lies inside of its shape. A beam from outside of all shapes
// therefore meets a polyhedron only behind t. If t > r + b, the beam met a flat surface before any shape, and b holds.
// Otherwise the true range is t, or that of a flat surface within b of r, or lies between r and t, since only the
// polyhedron may have hidden it: max(b, |r - t| + e) bounds the error. A beam that starts inside of a shape may meet
// the polyhedron before t, so that the larger bound always holds there. A shape that is not solid everywhere may let
// the beam pass where its polyhedron does not: the bound is then infinite.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/ray_caster.h>
#include "sensors/raster_depth/depth_range.h"

namespace simvis {

/// Whether a list has items that rays meet as exact shapes.
bool has_shapes(const DrawList& list);

class ShapeRanges {
 public:
  /// Casts beams into the exact shapes of a list: `directions[i]` is the unit vector of beam i in the sensor frame.
  void cast(const DrawList& list, const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions);

  /// The rendered range of a beam with a bound that includes the distance of the drawn mesh from its shape.
  RangeEstimate widened(std::size_t beam, const RangeEstimate& rendered) const;

 private:
  DrawList shapes_;          // the items with exact shapes, of one opaque material
  std::vector<bool> solid_;  // of these items
  std::unique_ptr<RayCaster> caster_;
  std::vector<RayHit> hits_;  // by beam; empty: there are no shapes
  bool inside_ = false;       // the sensor may be inside of a shape
};

}  // namespace simvis
