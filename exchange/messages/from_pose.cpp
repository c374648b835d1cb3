#include "exchange/messages/from_pose.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <simvis/pose.h>
#include "scenegraph/pose3.h"

namespace simvis::ros {

namespace {

// -0 becomes 0.
Quaternion to_quaternion(const glm::dquat& q) { return {q.x + 0.0, q.y + 0.0, q.z + 0.0, q.w + 0.0}; }
Vector3 to_vector(const glm::dvec3& v) { return {v.x + 0.0, v.y + 0.0, v.z + 0.0}; }

Pose to_pose_message(const glm::dmat4& rigid) {
  const Pose3 pose = pose_of(rigid);
  const Vector3 position = to_vector(pose.position_m);
  return {{position.x, position.y, position.z}, to_quaternion(pose.orientation)};
}

glm::dvec3 from_vector(const Vector3& v) { return {v.x, v.y, v.z}; }

using Covariance6 = std::array<double, 36>;

/// The covariance of (turn v + offset x (turn w), turn w) from that of (v, w), row by row.
Covariance6 carried(const Covariance6& of_own, const glm::dmat3& turn, const glm::dvec3& offset) {
  double jacobian[6][6] = {};
  for (int column = 0; column < 3; ++column) {
    const glm::dvec3 lever = glm::cross(offset, turn[column]);
    for (int row = 0; row < 3; ++row) {
      jacobian[row][column] = jacobian[row + 3][column + 3] = turn[column][row];
      jacobian[row][column + 3] = lever[row];
    }
  }
  Covariance6 result{};
  for (std::size_t row = 0; row < 6; ++row) {
    for (std::size_t column = 0; column < 6; ++column) {
      for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j) {
          result[row * 6 + column] += jacobian[row][i] * of_own[i * 6 + j] * jacobian[column][j];
        }
      }
    }
  }
  return result;
}

// A vehicle on wheels does not turn about the axes that wheels do not measure: a lever arm makes no uncertainty of
// these.
Covariance6 carried_measured(const Covariance6& of_own, const glm::dmat3& turn, const glm::dvec3& offset) {
  Covariance6 measured = of_own, unmeasured{};
  for (std::size_t i = 0; i < 6; ++i) {
    if (measured[i * 7] == kUnmeasured) std::swap(measured[i * 7], unmeasured[i * 7]);
  }
  Covariance6 result = carried(measured, turn, offset);
  const Covariance6 turned = carried(unmeasured, turn, glm::dvec3(0));
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += turned[i];
  return result;
}

/// The rotation as a vector: its axis times its angle, at most pi.
glm::dvec3 rotation_vector(const glm::dquat& q) {
  const glm::dquat shorter = q.w < 0 ? -q : q;
  const glm::dvec3 axis(shorter.x, shorter.y, shorter.z);
  const double sine = glm::length(axis);
  return sine == 0 ? glm::dvec3(0) : axis * (2 * std::atan2(sine, shorter.w) / sine);
}

}  // namespace

Time to_time(std::int64_t time_ns) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  return {static_cast<std::int32_t>(time_ns / kSecond), static_cast<std::uint32_t>(time_ns % kSecond)};
}

Header header_of(std::int64_t time_ns, std::string_view frame_id) { return {to_time(time_ns), std::string(frame_id)}; }

Transform to_transform(const glm::dmat4& rigid) {
  const Pose3 pose = pose_of(rigid);
  return {to_vector(pose.position_m), to_quaternion(pose.orientation)};
}

PoseStamped pose_stamped(const PoseAt& pose, const std::string& world_frame) {
  return {header_of(pose.time_ns, world_frame), to_pose_message(pose.world_from_body)};
}

Twist mean_twist(const PoseAt& before, const PoseAt& after) {
  const double seconds = static_cast<double>(after.time_ns - before.time_ns) / 1e9;
  const glm::dquat then = pose_of(before.world_from_body).orientation, now = pose_of(after.world_from_body).orientation;
  const glm::dvec3 moved = glm::dvec3(after.world_from_body[3]) - glm::dvec3(before.world_from_body[3]);
  const glm::dquat body_from_world = glm::conjugate(now);
  return {to_vector(body_from_world * moved / seconds),
          to_vector(rotation_vector(glm::conjugate(then) * now) / seconds)};
}

Odometry odometry(const PoseAt& before, const PoseAt& after, const std::string& world_frame,
                  const std::string& body_frame) {
  Odometry message;
  message.header = header_of(after.time_ns, world_frame);
  message.child_frame_id = body_frame;
  message.pose.pose = to_pose_message(after.world_from_body);
  message.twist.twist = mean_twist(before, after);
  return message;
}

// With t from the body to the own frame, in the body's axes: v_body = R v_own + t x R w_own, w_body = R w_own. The pose
// covariance is of small motions in the header's axes: the body's origin is at -R_pose t from the own one.
Odometry of_body(const Odometry& own, const glm::dmat4& body_from_own, const std::string& body_frame) {
  Odometry body = own;
  body.child_frame_id = body_frame;
  if (body_from_own == glm::dmat4(1)) return body;
  const Quaternion& q = own.pose.pose.orientation;
  const Point& p = own.pose.pose.position;
  glm::dmat4 header_from_own = glm::mat4_cast(glm::dquat(q.w, q.x, q.y, q.z));
  header_from_own[3] = glm::dvec4(p.x, p.y, p.z, 1);
  const glm::dmat4 header_from_body = header_from_own * rigid_inverse(body_from_own);
  body.pose.pose = to_pose_message(header_from_body);
  const glm::dmat3 turn(body_from_own);
  const glm::dvec3 offset(body_from_own[3]);
  const glm::dvec3 angular = turn * from_vector(own.twist.twist.angular);
  body.twist.twist = {to_vector(turn * from_vector(own.twist.twist.linear) + glm::cross(offset, angular)),
                      to_vector(angular)};
  body.twist.covariance = carried_measured(own.twist.covariance, turn, offset);
  const glm::dvec3 own_from_body = glm::dvec3(header_from_own[3]) - glm::dvec3(header_from_body[3]);
  body.pose.covariance = carried_measured(own.pose.covariance, glm::dmat3(1), own_from_body);
  return body;
}

}  // namespace simvis::ros
