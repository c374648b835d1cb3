// Where a body has been, in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/base/thinned_series.h"
#include "messages/from_pose.h"

namespace simvis {

/// Keeps the pose of each frame up to kMaxPoses frames. In longer runs it keeps that of every second, fourth, ... frame
/// from the first one on, and of the last frame.
class BodyPath {
 public:
  static constexpr std::size_t kMaxPoses = 16'384;

  /// The pose in the next frame.
  void add(const ros::PoseAt& pose);
  /// In ascending order of time, at most kMaxPoses + 1; evenly spaced in frames, except for the last one.
  std::vector<ros::PoseAt> poses() const;

 private:
  ThinnedSeries<ros::PoseAt, kMaxPoses> kept_;
  ros::PoseAt last_{};
};

}  // namespace simvis
