#include "messages/from_pose.h"

#include <cmath>

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

PoseStamped pose_stamped(const PoseAt& pose) {
  return {header_of(pose.time_ns, kWorldFrame), to_pose_message(pose.world_from_body)};
}

Twist mean_twist(const PoseAt& before, const PoseAt& after) {
  const double seconds = static_cast<double>(after.time_ns - before.time_ns) / 1e9;
  const glm::dquat then = pose_of(before.world_from_body).orientation, now = pose_of(after.world_from_body).orientation;
  const glm::dvec3 moved = glm::dvec3(after.world_from_body[3]) - glm::dvec3(before.world_from_body[3]);
  const glm::dquat body_from_world = glm::conjugate(now);
  return {to_vector(body_from_world * moved / seconds),
          to_vector(rotation_vector(glm::conjugate(then) * now) / seconds)};
}

Odometry odometry(const PoseAt& before, const PoseAt& after, const std::string& body_frame) {
  Odometry message;
  message.header = header_of(after.time_ns, kWorldFrame);
  message.child_frame_id = body_frame;
  message.pose.pose = to_pose_message(after.world_from_body);
  message.twist.twist = mean_twist(before, after);
  return message;
}

}  // namespace simvis::ros
