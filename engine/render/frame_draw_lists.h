// The draws of all views of a frame, in lists that the views share.
#pragma once

#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/base/thread_pool.h"
#include "engine/culling/strip_columns.h"
#include "engine/render/view_draw_list.h"

namespace simvis {

/// If the previous frame examined at least this many boxes and triangles (see ViewCounts), this frame uses worker
/// threads: examining them takes several times as long as waking a thread.
inline constexpr std::uint64_t kWorthThreads = 4000;

/// The lists keep their memory from frame to frame.
class FrameDrawLists {
 public:
  FrameDrawLists(const RasterTraits& raster, std::shared_ptr<ThreadPool> pool)
      : raster_(raster), pool_(std::move(pool)), strips_(pool_->size()) {}

  void clear();

  /// Builds the draw lists of all views of all passes, on all threads of the pool if there is enough work.
  void update(const FramePlan& plan, const DrawList& list, const DrawCache& table);

  /// Levels of round shapes that views need and that the table of the last update() does not have, ascending. The draw
  /// lists are complete only if there are none.
  std::span<const LackingLevel> lacking() const { return lacking_; }
  std::uint64_t items_culled() const { return items_culled_; }  ///< in the last update(), by all views

  std::span<const ViewDraws> views() const { return views_; }  ///< in the order of the plan
  std::span<const DrawRun> runs() const { return runs_; }
  std::span<const shader::Instance> instances() const { return instances_; }
  /// By instance: its item in DrawList::items. Empty if no pass has items; 0 for instances of other passes.
  std::span<const std::uint32_t> items() const { return items_; }
  std::span<const shader::LightBlock> lights() const { return lights_; }
  std::span<const std::uint32_t> indices() const { return indices_; }
  /// One span per view, in the order of views(). Valid until the next update() or clear().
  std::span<const std::span<const shader::CpuSelectedVertex>> cpu_selected() const { return cpu_selected_; }
  /// The vertices that the host has selected. Valid as long as the same of cpu_selected().
  std::span<const VertexCopies> copies() const { return copies_; }
  /// The number of these that are vertices of triangles. If it is above DrawCache::max_copies(), the large meshes have
  /// to be on the device.
  std::size_t triangle_copies() const { return triangle_copies_; }

 private:
  void append(const ViewDrawList& drawing, bool shadowed);

  RasterTraits raster_;
  std::shared_ptr<ThreadPool> pool_;
  std::vector<ViewDraws> views_;
  std::vector<DrawRun> runs_;
  std::vector<shader::Instance> instances_;
  std::vector<std::uint32_t> items_;
  std::vector<shader::LightBlock> lights_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::span<const shader::CpuSelectedVertex>>
      cpu_selected_;  // views into drawings_: copies would be too large
  std::size_t cpu_selected_count_ = 0;
  std::vector<VertexCopies> copies_;
  std::size_t copied_vertices_ = 0, triangle_copies_ = 0;
  std::size_t shadowed_ = 0;
  std::vector<LackingLevel> lacking_;
  std::uint64_t items_culled_ = 0;
  std::uint64_t looks_ = 0;            // boxes and triangles examined in the previous frame
  std::deque<ViewDrawList> drawings_;  // one per view; earlier frames may have needed more
  KnownStripColumns columns_;
  std::vector<ColumnOcclusionBuffer> strips_;  // one per thread
};

}  // namespace simvis
