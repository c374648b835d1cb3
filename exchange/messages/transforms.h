// The tree of frames: which transforms are fixed, and which move.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>

#include "exchange/messages/types/geometry_types.h"

namespace simvis::ros {

/// A transform that can move is for /tf from the start, because listeners of tf2 do not interpolate a frame that was
/// static once. One that cannot stays the same except for rounding, and is fixed, for /tf_static, until it first
/// differs from its first value by more than kFixed_m or kFixed, or has another parent. From then on it moves.
class Transforms {
 public:
  /// Of a position, in metres; of an element of a rotation. Both are far above the rounding of poses within kilometres
  /// of the origin and far below what a sensor can see.
  static constexpr double kFixed_m = 1e-6, kFixed = 1e-9;

  /// Begins a frame and clears the moving transforms.
  void begin(std::int64_t time_ns);
  /// `parent_from_child` is rigid. Each child has one parent in a frame.
  void set(const std::string& parent, const std::string& child, const glm::dmat4& parent_from_child, bool can_move);

  /// The transforms of this frame that move.
  const TFMessage& moving() const { return moving_; }
  /// All fixed transforms, if some are new or have left since the last call.
  std::optional<TFMessage> new_fixed();

 private:
  std::int64_t time_ns_ = 0;
  TFMessage moving_;
  struct Fixed {
    TransformStamped message;
    glm::dmat4 parent_from_child;
    bool moves = false;
  };
  std::map<std::string, Fixed> fixed_;  // by child
  bool changed_ = false;
};

}  // namespace simvis::ros
