// A frame that is made: what consumers of measurements get of it.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <span>

#include <simvis/draw_list.h>
#include <simvis/frame_time.h>
#include <simvis/measurement.h>
#include <simvis/object_tree.h>
#include "simvis/scene_builder.h"

namespace simvis {

/// A sensor that is on, and where it stands in a frame.
struct PlacedSensor {
  const BuiltSensor& sensor;
  glm::dmat4 world_from_sensor{1.0};
  const Measurement* measurement = nullptr;  ///< of this frame; null: it has not measured in it
};

/// The frame counts as made, and no consumer can change that. The references are valid until the next frame begins;
/// what a consumer needs longer it copies. Copies of images and scans share the numbers.
struct Frame {
  FrameTime time;
  const BuiltScene& scene;  ///< parameters, bodies, warnings and changes, as of this frame
  std::span<const PlacedSensor>
      sensors;           ///< in the order of their commands, without those that are off or have no pose
  const DrawList& list;  ///< what sensors see
  /// As Simulation::objects() has them. They are computed in the call, and valid until the next one.
  std::function<std::span<const SceneObject>()> objects;
};

}  // namespace simvis
