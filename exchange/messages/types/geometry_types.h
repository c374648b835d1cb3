// Messages of geometry_msgs, nav_msgs and tf2_msgs. Metres, radians; x forward, y left, z up (REP 103).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct Vector3 {
  SIMVIS_MESSAGE("geometry_msgs/msg/Vector3", x, y, z);
  double x = 0;
  double y = 0;
  double z = 0;
};

struct Point {
  SIMVIS_MESSAGE("geometry_msgs/msg/Point", x, y, z);
  double x = 0;
  double y = 0;
  double z = 0;
};

struct Quaternion {
  SIMVIS_MESSAGE("geometry_msgs/msg/Quaternion", x, y, z, w);
  double x = 0;
  double y = 0;
  double z = 0;
  double w = 0;
};

struct Transform {
  SIMVIS_MESSAGE("geometry_msgs/msg/Transform", translation, rotation);
  Vector3 translation;
  Quaternion rotation;
};

/// The transform header.frame_id from child_frame_id.
struct TransformStamped {
  SIMVIS_MESSAGE("geometry_msgs/msg/TransformStamped", header, child_frame_id, transform);
  Header header;
  std::string child_frame_id;
  Transform transform;
};

struct TFMessage {
  SIMVIS_MESSAGE("tf2_msgs/msg/TFMessage", transforms);
  std::vector<TransformStamped> transforms;
};

struct Pose {
  SIMVIS_MESSAGE("geometry_msgs/msg/Pose", position, orientation);
  Point position;
  Quaternion orientation;
};

struct PoseStamped {
  SIMVIS_MESSAGE("geometry_msgs/msg/PoseStamped", header, pose);
  Header header;
  Pose pose;
};

struct PoseWithCovariance {
  SIMVIS_MESSAGE("geometry_msgs/msg/PoseWithCovariance", pose, covariance);
  Pose pose;
  std::array<double, 36> covariance{};
};

struct Twist {
  SIMVIS_MESSAGE("geometry_msgs/msg/Twist", linear, angular);
  Vector3 linear;
  Vector3 angular;
};

struct TwistStamped {
  SIMVIS_MESSAGE("geometry_msgs/msg/TwistStamped", header, twist);
  Header header;
  Twist twist;
};

struct Wrench {
  SIMVIS_MESSAGE("geometry_msgs/msg/Wrench", force, torque);
  Vector3 force;
  Vector3 torque;
};

struct WrenchStamped {
  SIMVIS_MESSAGE("geometry_msgs/msg/WrenchStamped", header, wrench);
  Header header;
  Wrench wrench;
};

struct TwistWithCovariance {
  SIMVIS_MESSAGE("geometry_msgs/msg/TwistWithCovariance", twist, covariance);
  Twist twist;
  std::array<double, 36> covariance{};
};

struct TwistWithCovarianceStamped {
  SIMVIS_MESSAGE("geometry_msgs/msg/TwistWithCovarianceStamped", header, twist);
  Header header;
  TwistWithCovariance twist;
};

/// The pose is in header.frame_id, the twist in child_frame_id.
struct Odometry {
  SIMVIS_MESSAGE("nav_msgs/msg/Odometry", header, child_frame_id, pose, twist);
  Header header;
  std::string child_frame_id;
  PoseWithCovariance pose;
  TwistWithCovariance twist;
};

struct Path {
  SIMVIS_MESSAGE("nav_msgs/msg/Path", header, poses);
  Header header;
  std::vector<PoseStamped> poses;
};

}  // namespace simvis::ros
