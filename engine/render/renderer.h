// Draws a DrawList as a FramePlan says and reads the results back. One submission per frame.
#pragma once

#include <memory>
#include <span>

#include <simvis/draw_list.h>
#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>

namespace simvis {

class Device;

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
