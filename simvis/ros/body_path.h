// Where a body has been, in bounded memory.
#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/thinned_list.h"
#include "exchange/messages/from_pose.h"

namespace simvis {

/// Keeps the pose of each frame up to kMaxPoses frames. In longer runs it keeps that of every second, fourth, ... frame
/// from the first one on, and of the last frame.
class BodyPath {
 public:
  static constexpr std::size_t kMaxPoses = ThinnedList<ros::PoseAt>::kMaxKept;

  /// The pose in the next frame.
  void add(const ros::PoseAt& pose) { poses_.add(pose); }
  /// In ascending order of time, at most kMaxPoses + 1; evenly spaced in frames, except for the last one.
  std::vector<ros::PoseAt> poses() const { return poses_.values(); }

 private:
  ThinnedList<ros::PoseAt> poses_;
};

}  // namespace simvis
