// Resolves the poses of SDF: each is relative to a frame that another pose may define.
#pragma once

#include <string>

#include "import/sdf/sdf_model.h"

namespace simvis {

/// Names are those of a scope: its links, frames, joints and models, and MODEL::NAME within them. "__model__" is the
/// scope itself, as is "world" in the world. Throws InputError at `where` for a name that is not there and for frames
/// that refer to each other in a circle.
class SdfPoses {
 public:
  /// scope_from_frame of the frame with this name.
  glm::dmat4 frame(SdfScope& scope, const std::string& name, const SdfElement& where);
  /// scope_from_item.
  const glm::dmat4& item(SdfScope& scope, SdfItem& item);
  /// world_from_scope.
  glm::dmat4 scope(SdfScope& scope);
  /// scope_from_child of a pose in the scope, which is relative to `fallback` if it does not say to what.
  glm::dmat4 pose(SdfScope& scope, const SdfPose& pose, const std::string& fallback);
  /// The link that a name of a link, frame, joint or model means; null: the world.
  SdfItem* link(SdfScope& scope, const std::string& name, const SdfElement& where);

 private:
  class Step;
  int depth_ = 0;
};

}  // namespace simvis
