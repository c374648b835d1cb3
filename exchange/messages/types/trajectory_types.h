// Messages of trajectory_msgs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct Duration {
  SIMVIS_MESSAGE("builtin_interfaces/msg/Duration", sec, nanosec);
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};

struct JointTrajectoryPoint {
  SIMVIS_MESSAGE("trajectory_msgs/msg/JointTrajectoryPoint", positions, velocities, accelerations, effort,
                 time_from_start);
  std::vector<double> positions;
  std::vector<double> velocities;
  std::vector<double> accelerations;
  std::vector<double> effort;
  Duration time_from_start;
};

struct JointTrajectory {
  SIMVIS_MESSAGE("trajectory_msgs/msg/JointTrajectory", header, joint_names, points);
  Header header;
  std::vector<std::string> joint_names;
  std::vector<JointTrajectoryPoint> points;
};

}  // namespace simvis::ros
