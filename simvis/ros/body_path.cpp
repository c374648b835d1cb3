#include "simvis/ros/body_path.h"

namespace simvis {

void BodyPath::add(const ros::PoseAt& pose) {
  last_ = pose;
  if (frames_++ % spacing_ != 0) return;
  if (kept_.size() == kMaxPoses) {
    for (std::size_t i = 0; i < kMaxPoses / 2; ++i) kept_[i] = kept_[2 * i];
    kept_.resize(kMaxPoses / 2);
    spacing_ *= 2;
  }
  kept_.push_back(pose);
}

std::vector<ros::PoseAt> BodyPath::poses() const {
  std::vector<ros::PoseAt> poses = kept_;
  if (frames_ > 0 && (frames_ - 1) % spacing_ != 0) poses.push_back(last_);
  return poses;
}

}  // namespace simvis
