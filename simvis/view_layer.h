// The flattened world, frame plan and renderer of one audience of a simulation.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <simvis/device.h>
#include <simvis/frame_plan.h>
#include <simvis/ray_caster.h>
#include <simvis/step_costs.h>
#include "engine/render/renderer.h"
#include "scenegraph/flattener.h"
#include "simvis/ignored_items.h"
#include "simvis/scene_builder.h"

namespace simvis {

/// Sensors and people have separate layers, including the buffers: objects that are drawn for people cannot change the
/// measurements or the costs of a sensor.
struct ViewLayer {
  ViewLayer(GroupPtr root, Audience audience, Device& device)
      : flattener(std::move(root), audience),
        ignored(audience),
        renderer(device),
        caster(make_ray_caster(device)),
        list(&flattener.update()) {}

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

  /// The plan of this frame with the details that only reports and tests need. They are computed at the first call.
  const FramePlan& complete_plan();

  /// The sensors of this audience in this frame, for reports.
  std::vector<PlannedSensor> planned_sensors(std::span<const BuiltSensor> sensors) const;

  Flattener flattener;
  IgnoredItems ignored;  ///< of its sensors
  Renderer renderer;
  std::unique_ptr<RayCaster> caster;  ///< idle until a sensor casts rays
  const DrawList* list;               ///< result of the last flattening
  FramePlan plan;                     ///< of this frame
  std::vector<Entry> entries;         ///< of all sensors, due or not, in their order
  bool rendered = false;              ///< the plan has been rendered
  bool complete = false;
};

}  // namespace simvis
