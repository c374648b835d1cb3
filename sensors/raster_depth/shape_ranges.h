// What rendered ranges leave out of round shapes: a renderer draws a polyhedron, and the true range is that of the
// exact shape (see <simvis/exact_surface.h>).
//
// Let r be a rendered range with the bound b of the drawn triangles, and t the first range at which the beam meets an
// exact shape, cast with the bound e. The drawn polyhedron lies inside of its shape. A beam from outside of all shapes
// therefore meets a polyhedron only behind t. If t - e > r + b, the beam met a flat surface before any shape, and b
// holds. Otherwise the true range is t, or that of a flat surface within b of r, or lies between r and t, since only
// the polyhedron may have hidden it: max(b, |r - t| + e) bounds the error. If nothing was drawn where a shape is met,
// or if the shape is not solid everywhere and may let the beam pass where its polyhedron does not, the bound is
// infinite. A beam that starts inside of a shape may meet the polyhedron before t, so that the larger bound is taken
// there even if t is far behind r.
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

/// The exact shapes of the last list that was given to find(), and the ranges of the last cast() into them.
class ShapeRanges {
 public:
  /// Whether a list has items that rays meet as exact shapes. Of a list with a change log only the changes are read.
  bool find(const DrawList& list);

  /// Casts beams into the shapes of the list of the last find(): `directions[i]` is the unit vector of beam i in the
  /// sensor frame. `threads` as SimulationDesc::threads, the same at each call.
  void cast(const DrawList& list, const glm::dmat4& world_from_sensor, std::span<const glm::dvec3> directions,
            unsigned threads);

  /// The rendered range of a beam with a bound that includes the distance of the drawn mesh from its shape.
  RangeEstimate widened(std::size_t beam, const RangeEstimate& rendered) const;

 private:
  bool is_known(const DrawList& list) const;
  void place(const DrawList& list);

  ListVersion version_;              // of the list at the last find()
  std::vector<std::uint32_t> item_;  // of each shape, in DrawList::items
  DrawList shapes_;                  // a list of the shapes alone, of one opaque material, each with its own transform
  std::vector<bool> solid_;          // of each shape
  std::unique_ptr<RayCaster> caster_;
  std::vector<RayHit> hits_;  // by beam
  bool inside_ = false;       // the sensor may be inside of a shape
};

}  // namespace simvis
