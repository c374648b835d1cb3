// What all views of a frame draw, in lists that they share.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "engine/base/worker_threads.h"
#include "engine/culling/strip_columns.h"
#include "engine/render/view_draw_list.h"

namespace simvis {

/// Boxes and triangles to look at, in the frame before, that take several times as long as to wake a thread: see
/// ViewCounts.
inline constexpr std::uint64_t kWorthThreads = 4000;

/// Keeps its memory from frame to frame.
class FrameDrawLists {
 public:
  /// `snap_px` as in PassResult.
  explicit FrameDrawLists(double snap_px) : snap_px_(snap_px) {}

  void clear();

  /// Works out all views of all passes, on all cores where there is enough to do. Counts culled items.
  void update(const FramePlan& plan, const DrawList& list, const DrawCache& table, FrameCounters& counters);

  std::span<const ViewDraws> views() const { return views_; }  ///< in the order of the plan
  std::span<const DrawRun> runs() const { return runs_; }
  std::span<const shader::Instance> instances() const { return instances_; }
  std::span<const shader::LightBlock> lights() const { return lights_; }
  std::span<const std::uint32_t> indices() const { return indices_; }
  /// Of each view, one after the other.
  std::span<const std::span<const shader::CpuSelectedVertex>> cpu_selected() const { return cpu_selected_; }

 private:
  void append(const ViewDrawList& drawing, bool shadowed);

  double snap_px_;
  std::vector<ViewDraws> views_;
  std::vector<DrawRun> runs_;
  std::vector<shader::Instance> instances_;
  std::vector<shader::LightBlock> lights_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::span<const shader::CpuSelectedVertex>> cpu_selected_;  // in drawings_: too much to be copied
  std::size_t cpu_selected_count_ = 0;
  std::size_t shadowed_ = 0;
  std::uint64_t looks_ = 0;            // of the frame before, see ViewCounts
  std::deque<ViewDrawList> drawings_;  // of each view, and of those that earlier frames had more
  KnownStripColumns columns_;
  std::vector<ColumnOcclusionBuffer> strips_ =
      std::vector<ColumnOcclusionBuffer>(WorkerThreads::count());  // of each thread
  WorkerThreads threads_;
};

}  // namespace simvis
