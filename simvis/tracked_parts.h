// The parts of a scene whose poses are asked for.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include <simvis/scene.h>
#include "scenegraph/flattener.h"

namespace simvis {

/// Each has a mount of its own, which goes with the part. A new part of the same name is tracked again.
class TrackedParts {
 public:
  /// Throws InputError if there is no such part.
  void track(std::string_view part, Scene& scene);
  /// Follows a change of the scene.
  void follow(Scene& scene);
  /// Returns false if the part is switched off or was removed. Throws InputError if it is not tracked.
  bool pose(std::string_view part, const Flattener& flattener, glm::dmat4& world_from_part) const;

 private:
  std::map<std::string, std::shared_ptr<Mount>, std::less<>> mounts_;  // null: the part was removed
};

}  // namespace simvis
