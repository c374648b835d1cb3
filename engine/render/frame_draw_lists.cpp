#include "engine/render/frame_draw_lists.h"

#include <algorithm>

namespace simvis {
namespace {

template <typename T>
void append_to(std::vector<T>& all, std::span<const T> more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

void FrameDrawLists::clear() {
  views_.clear();
  runs_.clear();
  instances_.clear();
  items_.clear();
  lights_.clear();
  indices_.clear();
  cpu_selected_.clear();
  cpu_selected_count_ = 0;
  copies_.clear();
  copied_vertices_ = triangle_copies_ = 0;
  shadowed_ = 0;
  lacking_.clear();
  items_culled_ = 0;
}

void FrameDrawLists::update(const FramePlan& plan, const DrawList& list, const DrawCache& table) {
  struct Task {
    const Pass& pass;
    const View& view;
    const StripColumns* columns;
    ViewDrawList& drawing;
  };
  clear();
  std::vector<Task> tasks;
  for (const Pass& pass : plan.passes) {
    for (const View& view : pass.views) {
      if (tasks.size() == drawings_.size()) drawings_.emplace_back(raster_);
      tasks.push_back({pass, view, is_strip(view) ? &columns_.of(view) : nullptr, drawings_[tasks.size()]});
    }
  }
  // The work in the previous frame predicts the work in this frame.
  pool_->parallel_for(tasks.size(), looks_ >= kWorthThreads ? 1 : tasks.size(),
                      [&](std::size_t slot, std::size_t first, std::size_t count) {
                        for (const Task& task : std::span(tasks).subspan(first, count)) {
                          task.drawing.update(task.view, task.pass, task.columns, list, table, strips_[slot]);
                        }
                      });
  looks_ = 0;
  for (const Task& task : tasks) {
    const ViewCounts& counts = task.drawing.draws().counts;
    looks_ += counts.boxes_examined + counts.triangles_examined;
    append(task.drawing, !task.view.shadows.empty());
    items_culled_ += task.drawing.draws().items_culled;
    append_to(lacking_, task.drawing.lacking());
  }
  std::ranges::sort(lacking_);
  lacking_.erase(std::unique(lacking_.begin(), lacking_.end()), lacking_.end());
}

void FrameDrawLists::append(const ViewDrawList& drawing, bool shadowed) {
  ViewDraws& draws = views_.emplace_back(drawing.draws());
  for (std::size_t* const run : {&draws.first_run, &draws.first_layer, &draws.first_depth_visible, &draws.end_run}) {
    *run += runs_.size();
  }
  for (DrawRun run : drawing.runs().runs()) {
    if (run.key.cpu_selected) {
      run.range.first_index += static_cast<std::uint32_t>(cpu_selected_count_);
    } else {
      run.first_instance += static_cast<std::uint32_t>(instances_.size());
      if (run.own_indices) run.range.first_index += static_cast<std::uint32_t>(indices_.size());
      if (run.copied && run.own_indices) run.range.vertex_offset += static_cast<std::int32_t>(copied_vertices_);
      if (run.copied && !run.own_indices) run.range.first_index += static_cast<std::uint32_t>(copied_vertices_);
    }
    runs_.push_back(run);
  }
  draws.block.lights.x = static_cast<std::uint32_t>(lights_.size()) * SIMVIS_LIGHT_ROWS;
  if (shadowed) draws.shadowed = shadowed_++;
  const DrawRuns& runs = drawing.runs();
  const VisibleDraws& visible = drawing.visible();
  if (!runs.items().empty()) {
    items_.resize(instances_.size());
    append_to(items_, runs.items());
  }
  append_to(instances_, runs.instances());
  append_to(lights_, drawing.lights());
  append_to(indices_, visible.indices());
  cpu_selected_.push_back(runs.cpu_selected());
  cpu_selected_count_ += runs.cpu_selected().size();
  append_to(copies_, visible.copies());
  copied_vertices_ += visible.copied_vertices();
  triangle_copies_ += visible.triangle_copies();
}

}  // namespace simvis
