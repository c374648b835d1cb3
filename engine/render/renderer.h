// Renderer: draws a DrawList according to a FramePlan and reads the results back, with one submission per frame.
#pragma once

#include <memory>
#include <span>

#include <simvis/draw_list.h>
#include <simvis/frame_costs.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include "engine/base/program_api.h"

namespace simvis {

class Device;

/// Frames   see View. All products of transforms are computed in double and rounded once.
/// Special  an empty plan submits nothing. If a frame has more OIT layers than the memory holds, it is drawn again with
///          more memory, and its counters include both attempts.
/// Errors   MachineError with the Vulkan result (device lost, out of memory); InputError from submit() if a pass has a
///          larger size or more samples than the device allows.
/// Threading  only one thread may use a renderer. Several renderers may share a Device only on one thread.
class Renderer {
 public:
  SIMVIS_PROGRAM_API explicit Renderer(Device& device);
  SIMVIS_PROGRAM_API ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Submits every pass of the plan to the device and returns while the device draws. The caller must not change or
  /// destroy `list` and `plan` before collect().
  SIMVIS_PROGRAM_API void submit(const DrawList& list, const FramePlan& plan);

  /// Waits for the submitted frame. Result i belongs to plan.passes[i]. Call it once after each submit(), before the
  /// next submit().
  SIMVIS_PROGRAM_API std::span<const PassResult> collect();

  std::span<const PassResult> render(const DrawList& list, const FramePlan& plan) {
    submit(list, plan);
    return collect();
  }

  /// The counters of the last collect().
  const FrameCounters& counters() const;

  /// Adds to the plan of the last collect() the pipelines of each view and all memory that the renderer holds on the
  /// device. Frames for which it is not called do no extra work.
  void complete(FramePlan& plan) const;

  /// The costs of the last collect(); null unless the device is instrumented.
  const FrameCosts* costs() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace simvis
