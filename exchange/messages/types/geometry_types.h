// Messages of geometry_msgs, nav_msgs and tf2_msgs. Metres, radians; x forward, y left, z up (REP 103).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "exchange/messages/field.h"
#include "exchange/messages/types/std_types.h"

namespace simvis::ros {

struct Vector3 {
  static constexpr std::string_view kName = "geometry_msgs/msg/Vector3";
  double x = 0;
  double y = 0;
  double z = 0;
  static constexpr auto field_table() {
    return std::tuple{Field{"x", &Vector3::x}, Field{"y", &Vector3::y}, Field{"z", &Vector3::z}};
  }
};

struct Point {
  static constexpr std::string_view kName = "geometry_msgs/msg/Point";
  double x = 0;
  double y = 0;
  double z = 0;
  static constexpr auto field_table() {
    return std::tuple{Field{"x", &Point::x}, Field{"y", &Point::y}, Field{"z", &Point::z}};
  }
};

struct Quaternion {
  static constexpr std::string_view kName = "geometry_msgs/msg/Quaternion";
  double x = 0;
  double y = 0;
  double z = 0;
  double w = 0;
  static constexpr auto field_table() {
    return std::tuple{Field{"x", &Quaternion::x}, Field{"y", &Quaternion::y}, Field{"z", &Quaternion::z},
                      Field{"w", &Quaternion::w}};
  }
};

struct Transform {
  static constexpr std::string_view kName = "geometry_msgs/msg/Transform";
  Vector3 translation;
  Quaternion rotation;
  static constexpr auto field_table() {
    return std::tuple{Field{"translation", &Transform::translation}, Field{"rotation", &Transform::rotation}};
  }
};

/// The transform header.frame_id from child_frame_id.
struct TransformStamped {
  static constexpr std::string_view kName = "geometry_msgs/msg/TransformStamped";
  Header header;
  std::string child_frame_id;
  Transform transform;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &TransformStamped::header},
                      Field{"child_frame_id", &TransformStamped::child_frame_id},
                      Field{"transform", &TransformStamped::transform}};
  }
};

struct TFMessage {
  static constexpr std::string_view kName = "tf2_msgs/msg/TFMessage";
  std::vector<TransformStamped> transforms;
  static constexpr auto field_table() { return std::tuple{Field{"transforms", &TFMessage::transforms}}; }
};

struct Pose {
  static constexpr std::string_view kName = "geometry_msgs/msg/Pose";
  Point position;
  Quaternion orientation;
  static constexpr auto field_table() {
    return std::tuple{Field{"position", &Pose::position}, Field{"orientation", &Pose::orientation}};
  }
};

struct PoseStamped {
  static constexpr std::string_view kName = "geometry_msgs/msg/PoseStamped";
  Header header;
  Pose pose;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &PoseStamped::header}, Field{"pose", &PoseStamped::pose}};
  }
};

struct PoseWithCovariance {
  static constexpr std::string_view kName = "geometry_msgs/msg/PoseWithCovariance";
  Pose pose;
  std::array<double, 36> covariance{};
  static constexpr auto field_table() {
    return std::tuple{Field{"pose", &PoseWithCovariance::pose}, Field{"covariance", &PoseWithCovariance::covariance}};
  }
};

struct Twist {
  static constexpr std::string_view kName = "geometry_msgs/msg/Twist";
  Vector3 linear;
  Vector3 angular;
  static constexpr auto field_table() {
    return std::tuple{Field{"linear", &Twist::linear}, Field{"angular", &Twist::angular}};
  }
};

struct TwistStamped {
  static constexpr std::string_view kName = "geometry_msgs/msg/TwistStamped";
  Header header;
  Twist twist;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &TwistStamped::header}, Field{"twist", &TwistStamped::twist}};
  }
};

struct Wrench {
  static constexpr std::string_view kName = "geometry_msgs/msg/Wrench";
  Vector3 force;
  Vector3 torque;
  static constexpr auto field_table() {
    return std::tuple{Field{"force", &Wrench::force}, Field{"torque", &Wrench::torque}};
  }
};

struct WrenchStamped {
  static constexpr std::string_view kName = "geometry_msgs/msg/WrenchStamped";
  Header header;
  Wrench wrench;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &WrenchStamped::header}, Field{"wrench", &WrenchStamped::wrench}};
  }
};

struct TwistWithCovariance {
  static constexpr std::string_view kName = "geometry_msgs/msg/TwistWithCovariance";
  Twist twist;
  std::array<double, 36> covariance{};
  static constexpr auto field_table() {
    return std::tuple{Field{"twist", &TwistWithCovariance::twist},
                      Field{"covariance", &TwistWithCovariance::covariance}};
  }
};

/// The pose is in header.frame_id, the twist in child_frame_id.
struct Odometry {
  static constexpr std::string_view kName = "nav_msgs/msg/Odometry";
  Header header;
  std::string child_frame_id;
  PoseWithCovariance pose;
  TwistWithCovariance twist;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &Odometry::header}, Field{"child_frame_id", &Odometry::child_frame_id},
                      Field{"pose", &Odometry::pose}, Field{"twist", &Odometry::twist}};
  }
};

struct Path {
  static constexpr std::string_view kName = "nav_msgs/msg/Path";
  Header header;
  std::vector<PoseStamped> poses;
  static constexpr auto field_table() {
    return std::tuple{Field{"header", &Path::header}, Field{"poses", &Path::poses}};
  }
};

}  // namespace simvis::ros
