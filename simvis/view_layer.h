// What one audience of a simulation sees: its flattened world, its plan, its renderer.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "engine/device.h"
#include "engine/frame_plan.h"
#include "engine/ray_caster.h"
#include "engine/renderer.h"
#include "scenegraph/flattener.h"

namespace simvis {

/// Sensors and people each have a layer of their own, down to the buffers: nothing that is drawn for people can touch
/// what a sensor sees or costs.
struct ViewLayer {
  ViewLayer(GroupPtr root, Audience audience, Device& device)
      : flattener(std::move(root), audience),
        renderer(device),
        caster(make_ray_caster(device)),
        list(&flattener.update()) {}

  Flattener flattener;
  Renderer renderer;
  std::unique_ptr<RayCaster> caster;  ///< costs nothing until a sensor casts
  const DrawList* list;               ///< as of the last flattening
  FramePlan plan;                     ///< of this frame
  std::vector<std::size_t> due;       ///< the sensors that measure in this frame, by index
};

}  // namespace simvis
