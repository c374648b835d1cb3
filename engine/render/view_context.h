// The data that the three stages of listing a view's draws share. In draw_candidates.h the view selects drawables, in
// visible_draws.h it culls them, in draw_runs.h it records the draws.
#pragma once

#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include "engine/culling/column_occlusion_buffer.h"
#include "engine/culling/point_selector.h"
#include "engine/geometry/view_projection.h"
#include "engine/render/draw_cache.h"
#include "shaders/interop.h"

namespace simvis {

/// Whether the view is a strip: culled and at least eight times as wide as high (see guard_rows()). The host then tests
/// single triangles.
inline bool is_strip(const View& view) { return view.culled && guard_rows(view) > 0; }

/// Returns true if, on a CPU device, the host selects the triangles that the view sees. The view then draws copies of
/// their vertices, and large opaque meshes need not be on the device.
inline bool cpu_selects_triangles(const View& view, const Pass& pass) {
  return view.culled && !is_strip(view) && !view.orthographic && !pass.shadow_maps;
}

/// The same of the points of large clouds.
inline bool cpu_selects_points(const View& view, const Pass& pass) {
  return cpu_selects_triangles(view, pass) && pass.msaa == 1;
}

/// Whether the host selects all opaque triangles that the view draws. The view then needs no device copy of these
/// meshes.
inline bool cpu_selects_opaque(const View& view) { return is_strip(view) && view.sees_back_faces; }

/// How the device draws.
struct RasterTraits {
  double snap_px = 0;               ///< as in PassResult
  PointSizes points;                ///< of points with a size
  bool selects_primitives = false;  ///< the host selects single triangles and points of all culled views, because
                                    ///< drawing one costs the device more than testing it costs the host
};

/// Pixels of a view, from the first ones to those before the last ones. Empty if not first < last.
struct PixelRect {
  glm::uvec2 first{0}, last{0};

  bool empty() const { return first.x >= last.x || first.y >= last.y; }
  bool operator==(const PixelRect&) const = default;
};

/// The phases in which the runs of a view are drawn.
enum class DrawPhase : std::uint8_t { solid, layers, depth_visible };
inline constexpr std::uint32_t kDrawPhases = 3;

/// The runs of one view: [first_run, first_layer) are solid, [first_layer, first_depth_visible) are transparent, and
/// [first_depth_visible, end_run) repeat the depth-visible transparent runs for depth.
struct ViewDraws {
  shader::ViewBlock block;
  std::size_t shadowed = 0;  ///< index among the views with shadows, if it has any; see ShadowMaps::first_texel()
  std::size_t first_run = 0, first_layer = 0, first_depth_visible = 0, end_run = 0;
  PixelRect layered;               ///< holds all pixels that show a transparent surface; relative to the view
  std::vector<DrawnLevel> levels;  ///< see View::levels
  ViewCounts counts;
  std::uint64_t items_culled = 0;
};

/// A view that is being listed. Valid during ViewDrawList::update().
struct ViewContext {
  const View& view;
  const Pass& pass;
  const DrawList& list;
  const DrawCache& cache;
  const RasterTraits& raster;
  ColumnOcclusionBuffer* strip;  ///< null unless the view is a strip
  ViewProjection projection;
  ViewDraws& draws;  ///< the stages add to its counts and levels

  /// Whether the device draws only the front faces of a drawable.
  bool culls_backs(const Drawable& d) const {
    return d.key.topology == Topology::triangles && d.single_sided && !view.sees_back_faces;
  }
};

}  // namespace simvis
