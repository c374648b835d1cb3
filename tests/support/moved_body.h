// The motion of a body in a MovingScene, as physics has it.
#pragma once

#include <string>

#include "elements/sensed_physics.h"
#include "tests/support/moving_scene.h"

namespace simvis::test {

inline SensedPhysics& physics_of(MovingScene& scene) { return *find_physics((*scene).scene); }

/// A scene whose frames note the motion of the body at a point.
class MovedBody {
 public:
  MovedBody(const std::string& commands, const std::string& point, const std::filesystem::path& folder = "")
      : scene(commands, folder), point_(point) {
    physics_of(scene).follow_points({point});
  }
  /// After the last step of the last frame, which made at least one.
  StepMotion::At motion() { return physics_of(scene).motion_of(point_).value().after; }

  MovingScene scene;

 private:
  std::string point_;
};

}  // namespace simvis::test
