#include "engine/geometry/plane_rounding.h"

#include <algorithm>

#include "engine/geometry/view_projection.h"

namespace simvis {

RasterReach raster_reach(const View& view, double depth_snap_px) {
  const double width = view.width_px, height = view.height_px, guard = guard_rows(view);
  return {.x_px = view.x_px + width,
          .y_px = std::max(view.y_px + height + guard, guard - view.y_px),
          .width_px = width,
          .height_px = height + 2 * guard,
          .depth_snap_px = depth_snap_px};
}

}  // namespace simvis
