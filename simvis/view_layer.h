// The flattened world, frame plan and renderer of one audience of a simulation.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <simvis/frame_plan.h>
#include <simvis/ray_caster.h>
#include <simvis/step_costs.h>
#include "engine/render/renderer.h"
#include "engine/splats/splat_caster.h"
#include "scenegraph/flattener.h"
#include "simvis/ignored_items.h"
#include "simvis/lazy_device.h"
#include "simvis/scene_builder.h"

namespace simvis {

/// Sensors and people have separate layers, including the buffers: objects that are drawn for people cannot change the
/// measurements or the costs of a sensor.
struct ViewLayer {
  /// The device outlives the layer.
  ViewLayer(GroupPtr root, Audience audience, LazyDevice& device);

  /// A sensor of this audience in this frame.
  struct Entry {
    std::size_t sensor = 0;  ///< index among the sensors of the scene
    DueState due_state = DueState::due;
    std::size_t first_pass = 0, end_pass = 0, first_cast = 0, end_cast = 0;  ///< in the plan
    bool draws = false;  ///< it has views in the passes of the plan; other sensors may share these passes
    bool taken = false;  ///< it has received its results
    SensorCost cost{};   ///< cost of processing the results, if the device is instrumented
  };

  /// Starts the plan of the next frame.
  void begin_plan();
  /// Makes what the plan of the frame needs to draw and to cast, with the effects of the scene on the whole frame. Call
  /// it when all sensors have planned. Throws as Device.
  void finish_plan();

  /// As those of the renderer. Nothing happens, and there are no results, until a plan has drawn.
  void submit();
  std::span<const PassResult> collect();
  const FrameCounters& counters() const;
  const FrameCosts* costs() const { return renderer ? renderer->costs() : nullptr; }

  /// Whether a visible item of `list` has Gaussian splats. It is computed when the structure of the list has changed.
  bool has_splats();
  /// The caster of the rays of a sensor of this type in this frame.
  RayCaster& caster_for(const SensorType& type);

  /// The plan of this frame with the details that only reports and tests need. They are computed at the first call.
  const FramePlan& complete_plan();

  /// The sensors of this audience in this frame, for reports.
  std::vector<PlannedSensor> planned_sensors(std::span<const BuiltSensor> sensors) const;

  LazyDevice& device;
  Flattener flattener;
  IgnoredItems ignored;               ///< of its sensors
  std::optional<Renderer> renderer;   ///< since a plan has drawn, or from the start if the device is instrumented
  std::unique_ptr<RayCaster> caster;  ///< idle until a sensor casts rays; that of the host until a plan has rays
  SplatCaster splat_caster;           ///< of `caster`, for sensors whose rays hit splats
  std::optional<std::pair<std::uint64_t, bool>> known_splats{};  ///< revision of the structure, and has_splats()
  bool has_cast = false;                                         ///< a plan has had rays
  const DrawList* list;                                          ///< result of the last flattening
  FramePlan plan;                                                ///< of this frame
  std::vector<Entry> entries;                                    ///< of all sensors, due or not, in their order
  bool rendered = false;                                         ///< the plan has been rendered
  bool complete = false;
};

}  // namespace simvis
