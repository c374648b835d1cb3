// The draws of one view, made in three stages: draw_candidates.h selects, visible_draws.h culls, draw_runs.h records.
#pragma once

#include <span>
#include <vector>

#include "engine/render/draw_runs.h"

namespace simvis {

/// The lists keep their memory from view to view. All indices refer to the lists of this object.
class ViewDrawList {
 public:
  explicit ViewDrawList(const RasterTraits& raster) : raster_(raster) {}

  /// Builds the draws of one view and replaces those of the previous view. `columns` are the columns of the view if it
  /// is a strip, and null otherwise; `strip` is used only with `columns`. Several threads may call this on different
  /// objects with the same list and cache.
  void update(const View& view, const Pass& pass, const StripColumns* columns, const DrawList& list,
              const DrawCache& cache, ColumnOcclusionBuffer& strip);

  const ViewDraws& draws() const { return draws_; }
  std::span<const shader::LightBlock> lights() const { return lights_; }
  const DrawRuns& runs() const { return runs_; }
  const VisibleDraws& visible() const { return visible_; }
  /// As in DrawCandidates. The view is complete only if there are none.
  std::span<const LackingLevel> lacking() const { return candidates_.lacking(); }

 private:
  void add_lights(const ViewContext& context);
  std::span<const DrawCandidate> add_queue(const ViewContext& context, const RenderQueue& queue);

  RasterTraits raster_;
  ViewDraws draws_;
  std::vector<shader::LightBlock> lights_;
  DrawCandidates candidates_;
  VisibleDraws visible_;
  DrawRuns runs_;
};

}  // namespace simvis
