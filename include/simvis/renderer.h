// Draws a DrawList as a FramePlan says and reads the results back. One submission per frame.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>

namespace simvis {

class Device;

/// What a frame cost, counted and not timed.
struct FrameCounters {
  std::uint64_t passes = 0, views = 0, draws = 0, triangles = 0, pipelines_bound = 0, dispatches = 0;
  std::uint64_t pipelines_made = 0;  ///< compiled, or taken from the cache of earlier runs
  std::uint64_t bytes_uploaded = 0, bytes_read_back = 0;
  std::uint64_t items_culled = 0;
  std::uint64_t meshes_held = 0, textures_held = 0;  ///< on the device, after the frame
  std::uint64_t mesh_bytes = 0, texture_bytes = 0;   ///< that they take there
  std::uint64_t layers = 0;                          ///< of transparent surfaces, over all samples: see OitBuffer
  std::uint64_t layer_bytes = 0;                     ///< of memory for them, on the device after the frame

  bool operator==(const FrameCounters&) const = default;
};

/// What one view cost, counted and not timed.
struct ViewCounts {
  std::uint64_t draws = 0, triangles = 0;
  std::uint64_t masked_triangles = 0;                        ///< of them: each of their pixels asks for alpha
  std::uint64_t boxes_examined = 0, triangles_examined = 0;  ///< held against the view by the host: see Cluster

  bool operator==(const ViewCounts&) const = default;
};

/// Where a pass's pixels lie. Valid until the next submit() or the renderer's end.
struct PassResult {
  std::span<const float> depth;       ///< width * height, rows from the top, d = near / z; empty if not asked for
  std::span<const glm::vec4> color;   ///< width * height, rows from the top, linear RGBA; empty if not asked for
  std::span<const ViewCounts> views;  ///< views[i] belongs to the pass's views[i]
  /// Vertices are moved to a grid, by up to so many pixels along each axis, before pixels are found that a triangle
  /// covers. Vulkan leaves open whether depth is then taken from where they were, or from where they are now.
  double snap_px = 0;
  double depth_snap_px = 0;  ///< snap_px, or 0 on a device of which it is known that depth is not moved
};

/// Frames   see View. All products of transforms are formed in double and rounded once.
/// Special  an empty plan submits nothing. A frame that shows more layers of transparent surfaces than there is memory
///          for is drawn again with more, and its counters count both.
/// Errors   MachineError with the Vulkan result (device lost, out of memory); InputError from submit() if a pass is
///          larger than the device allows, or has more samples.
/// Threading  one renderer, one thread. Several renderers may share a Device only from one thread.
class Renderer {
 public:
  explicit Renderer(Device& device);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Hands every pass of the plan to the device, and returns while that draws. List and plan stay as they are until
  /// collect().
  void submit(const DrawList& list, const FramePlan& plan);

  /// Waits for what was submitted; result i belongs to plan.passes[i]. Once for each submit(), before the next.
  std::span<const PassResult> collect();

  std::span<const PassResult> render(const DrawList& list, const FramePlan& plan) {
    submit(list, plan);
    return collect();
  }

  /// Of the last collect().
  const FrameCounters& counters() const;

  /// Adds to the plan of the last collect() what it took to draw it: the pipelines of each view, and all memory that
  /// the renderer holds on the device. Costs nothing unless it is called.
  void complete(FramePlan& plan) const;

  /// Of the last collect(); null unless the device is instrumented.
  const FrameCosts* costs() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace simvis
