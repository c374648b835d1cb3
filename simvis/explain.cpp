#include "simvis/explain.h"

#include <sstream>

namespace simvis {

std::string explain(const FramePlan& plan, const FrameCounters& counters) {
  std::ostringstream out;
  for (const Pass& pass : plan.passes) {
    out << "pass " << pass.name << ": " << pass.width_px << " x " << pass.height_px << ',';
    if (pass.color) out << " colour";
    if (pass.color && pass.depth) out << " and";
    if (pass.depth) out << " depth";
    if (pass.shadow_maps) out << " shadow maps";
    if (pass.samples() > 1) {
      out << ", the mean of " << pass.samples() << " samples a pixel: " << pass.grid << " x " << pass.grid
          << " of msaa " << pass.msaa;
    }
    out << '\n';
    for (const View& view : pass.views) {
      out << "  view " << view.name << ": " << view.width_px << " x " << view.height_px << " at " << view.x_px << ' '
          << view.y_px << ", near " << view.near_m << " m: " << view.reason << '\n';
    }
  }
  for (const RayCast& cast : plan.casts) {
    out << "cast " << cast.name << ": up to " << cast.most_rays << " rays by " << cast.engine << ": " << cast.reason
        << '\n';
  }
  out << counters.passes << " passes, " << counters.views << " views, " << counters.draws << " draws, "
      << counters.triangles << " triangles, " << counters.pipelines_bound << " pipelines bound, " << counters.dispatches
      << " dispatches, " << counters.items_culled << " items culled, " << counters.bytes_uploaded << " bytes uploaded, "
      << counters.bytes_read_back << " bytes read back, " << counters.meshes_held << " meshes of "
      << counters.mesh_bytes << " bytes and " << counters.textures_held << " textures of " << counters.texture_bytes
      << " bytes held\n";
  return out.str();
}

}  // namespace simvis
