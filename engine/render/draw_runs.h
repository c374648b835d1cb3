// Third stage of a view's draws: instances, and runs of instanced draws.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/render/visible_draws.h"

namespace simvis {

/// One instanced draw.
struct DrawRun {
  PipelineKey key;
  VkDescriptorSet texture = VK_NULL_HANDLE;
  MeshRange range;
  std::uint32_t first_instance = 0, instance_count = 0;
  bool depth_visible = true;  ///< visible to depth passes and sensors
  float point_m = 0;          ///< as in Drawable
  bool own_indices = false;   ///< range.first_index counts in the view's indices, not in the geometry pool.
                              ///< With key.cpu_selected, it counts in cpu_selected(), without indices.
  bool copied = false;        ///< its vertices are copies; without own indices, range.first_index counts in these

  bool is_indexed() const { return !key.cpu_selected && (!copied || own_indices); }
  /// The triangles of all instances together; 0 for lines and points.
  std::uint64_t triangles() const {
    return key.topology == Topology::triangles ? std::uint64_t{range.index_count / 3} * instance_count : 0;
  }
};

/// Keeps its memory from view to view.
class DrawRuns {
 public:
  /// Starts a view without runs.
  void clear();

  /// Adds the draws of a queue.
  void record(const ViewContext& context, std::span<const VisibleDraw> visible);

  /// Adds all triangles of a strip with one draw. Their owners are numbers of candidates.
  void record_strip(const ViewContext& context, std::span<const StripTriangle> triangles,
                    std::span<const DrawCandidate> candidates);

  /// Adds the depth-visible ones of the transparent runs [first, end) a second time, for depth.
  void repeat_for_depth(std::size_t first, std::size_t end);

  /// Completes the keys of all runs, and counts the draws.
  void finish(const ViewContext& context);

  std::size_t size() const { return runs_.size(); }
  std::span<const DrawRun> runs() const { return runs_; }
  std::span<const shader::Instance> instances() const { return instances_; }
  /// By instance: its item in DrawList::items; empty unless the pass has items.
  std::span<const std::uint32_t> items() const { return items_; }
  std::span<const shader::CpuSelectedVertex> cpu_selected() const { return cpu_selected_; }

 private:
  void add_instance(const ViewContext& context, const DrawCandidate& candidate);

  std::vector<DrawRun> runs_;
  std::vector<shader::Instance> instances_;
  std::vector<std::uint32_t> items_;
  std::vector<shader::CpuSelectedVertex> cpu_selected_;
};

}  // namespace simvis
