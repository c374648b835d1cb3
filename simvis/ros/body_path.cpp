#include "simvis/ros/body_path.h"

namespace simvis {

void BodyPath::add(const ros::PoseAt& pose) {
  last_ = pose;
  kept_.add(pose);
}

std::vector<ros::PoseAt> BodyPath::poses() const {
  std::vector<ros::PoseAt> poses = kept_.kept();
  if (kept_.count() > 0 && !kept_.keeps_last()) poses.push_back(last_);
  return poses;
}

}  // namespace simvis
