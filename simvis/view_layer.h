// What one audience of a simulation sees: its flattened world, its plan, its renderer.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <simvis/device.h>
#include <simvis/frame_plan.h>
#include <simvis/ray_caster.h>
#include <simvis/renderer.h>
#include <simvis/sensor_cost.h>
#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"

namespace simvis {

/// Sensors and people each have a layer of their own, down to the buffers: nothing that is drawn for people can touch
/// what a sensor sees or costs.
struct ViewLayer {
  ViewLayer(GroupPtr root, Audience audience, Device& device)
      : flattener(std::move(root), audience),
        renderer(device),
        caster(make_ray_caster(device)),
        list(&flattener.update()) {}

  /// A sensor of this audience in this frame.
  struct Entry {
    std::size_t sensor = 0;  ///< index
    DueState due_state = DueState::due;
    std::size_t first_pass = 0, end_pass = 0, first_cast = 0, end_cast = 0;  ///< in the plan
    bool draws = false;  ///< it has views in the plan's passes, which may be others' too
    bool taken = false;  ///< it has its results
    SensorCost cost{};   ///< of that, where the device is instrumented
  };

  /// Starts the plan of the next frame.
  void begin_plan();

  /// The plan of this frame, with all that only people and tests want to know: worked out when it is first asked for.
  const FramePlan& complete_plan(std::span<const BuiltSensor> sensors);

  Flattener flattener;
  Renderer renderer;
  std::unique_ptr<RayCaster> caster;  ///< costs nothing until a sensor casts
  const DrawList* list;               ///< as of the last flattening
  FramePlan plan;                     ///< of this frame
  std::vector<Entry> entries;         ///< of the sensors, due or not, in their order
  bool rendered = false;              ///< the plan has been
  bool complete = false;
};

}  // namespace simvis
