// Where a body has been, in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "messages/from_pose.h"

namespace simvis {

/// Keeps the pose of each frame up to kMaxPoses frames. In longer runs it keeps that of every second, fourth, ... frame
/// from the first one on, and of the last frame.
class BodyPath {
 public:
  static constexpr std::size_t kMaxPoses = 16'384;  ///< even, so that the kept frames stay evenly spaced

  /// The pose in the next frame.
  void add(const ros::PoseAt& pose);
  /// In ascending order of time, at most kMaxPoses + 1; evenly spaced in frames, except for the last one.
  std::vector<ros::PoseAt> poses() const;

 private:
  std::vector<ros::PoseAt> kept_;
  ros::PoseAt last_{};
  std::uint64_t frames_ = 0, spacing_ = 1;
};

}  // namespace simvis
