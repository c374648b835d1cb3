// Messages of trajectory_msgs.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct Duration {
  static constexpr std::string_view kName = "builtin_interfaces/msg/Duration";
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
  static constexpr auto field_table() {
    return std::tuple{Field{"sec", &Duration::sec}, Field{"nanosec", &Duration::nanosec}};
  }
};

struct JointTrajectoryPoint {
  static constexpr std::string_view kName = "trajectory_msgs/msg/JointTrajectoryPoint";
  std::vector<double> positions;
  std::vector<double> velocities;
  std::vector<double> accelerations;
  std::vector<double> effort;
  Duration time_from_start;
  static constexpr auto field_table() {
    return std::tuple{
        Field{"positions", &JointTrajectoryPoint::positions}, Field{"velocities", &JointTrajectoryPoint::velocities},
        Field{"accelerations", &JointTrajectoryPoint::accelerations}, Field{"effort", &JointTrajectoryPoint::effort},
        Field{"time_from_start", &JointTrajectoryPoint::time_from_start}};
  }
};

struct JointTrajectory {
  static constexpr std::string_view kName = "trajectory_msgs/msg/JointTrajectory";
  Header header;
  std::vector<std::string> joint_names;
  std::vector<JointTrajectoryPoint> points;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &JointTrajectory::header}, Field{"joint_names", &JointTrajectory::joint_names},
                      Field{"points", &JointTrajectory::points}};
  }
};

}  // namespace simvis::ros
