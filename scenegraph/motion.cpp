#include "scenegraph/motion.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <utility>

#include <simvis/pose.h>

namespace simvis {

namespace {

double seconds_between(std::int64_t before_ns, std::int64_t now_ns) {
  return static_cast<double>(now_ns - before_ns) / 1e9;
}

/// The rotation as its axis times its angle, at most pi.
glm::dvec3 rotation_vector_of(const glm::dmat3& rotation) {
  const glm::dquat q = glm::normalize(glm::quat_cast(rotation)), shorter = q.w < 0 ? -q : q;
  const glm::dvec3 axis(shorter.x, shorter.y, shorter.z);
  const double sine = glm::length(axis);
  return sine == 0 ? glm::dvec3(0) : axis * (2 * std::atan2(sine, shorter.w) / sine);
}

/// (1 - (angle / 2) cot(angle / 2)) / angle^2, which logarithm() multiplies by angle^2. Its series is used where the
/// difference would cancel. At the limit between both, cancellation and the first missing term, angle^4 / 30240, are
/// below 2^-53 after that factor.
double second_coefficient(double angle) {
  constexpr double kSeriesBelow = 1e-3;
  if (angle < kSeriesBelow) return 1.0 / 12 + angle * angle / 720;
  return (1 - angle / 2 / std::tan(angle / 2)) / (angle * angle);
}

/// The logarithm of a rigid matrix: rotation vector and the linear part of the screw.
std::pair<glm::dvec3, glm::dvec3> logarithm(const glm::dmat4& rigid) {
  const glm::dvec3 turn = rotation_vector_of(glm::dmat3(rigid)), moved(rigid[3]);
  const glm::dvec3 across = glm::cross(turn, moved);
  return {turn, moved - 0.5 * across + second_coefficient(glm::length(turn)) * glm::cross(turn, across)};
}

}  // namespace

Twist twist_between(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now, double seconds) {
  const glm::dmat3 before_from_world = glm::transpose(glm::dmat3(world_from_before));
  // The difference of the positions is taken first, so that it keeps its digits far from the origin.
  glm::dmat4 before_from_now(before_from_world * glm::dmat3(world_from_now));
  before_from_now[3] =
      glm::dvec4(before_from_world * (glm::dvec3(world_from_now[3]) - glm::dvec3(world_from_before[3])), 1);
  const auto [turn, screw] = logarithm(before_from_now);
  return {turn / seconds, screw / seconds};
}

void PoseHistory::add(std::int64_t time_ns, const glm::dmat4& world_from_body) {
  // A frame may be made again, and a frame that failed may be followed by an earlier one.
  for (; count_ > 0 && poses_[0].time_ns >= time_ns; --count_) {
    poses_[0] = poses_[1];
    poses_[1] = poses_[2];
  }
  poses_[2] = poses_[1];
  poses_[1] = poses_[0];
  poses_[0] = {time_ns, world_from_body};
  count_ = count_ < poses_.size() ? count_ + 1 : count_;
}

Motion PoseHistory::motion() const {
  if (count_ < 2) return {};
  const auto twist = [&](std::size_t before, std::size_t now) {
    return twist_between(poses_[before].world_from_body, poses_[now].world_from_body,
                         seconds_between(poses_[before].time_ns, poses_[now].time_ns));
  };
  const Twist last = twist(1, 0);
  glm::dvec3 angular_change(0), linear_change(0);  // per second
  if (count_ > 2) {
    const Twist earlier = twist(2, 1);
    const double between_s = seconds_between(poses_[2].time_ns, poses_[0].time_ns) / 2;
    angular_change = (last.angular_radps - earlier.angular_radps) / between_s;
    linear_change = (last.linear_mps - earlier.linear_mps) / between_s;
  }
  const glm::dmat3 world_from_body(poses_[0].world_from_body);
  return {.velocity_mps = world_from_body * last.linear_mps,
          .angular_velocity_radps = world_from_body * last.angular_radps,
          .acceleration_mps2 = world_from_body * (linear_change + glm::cross(last.angular_radps, last.linear_mps)),
          .angular_acceleration_radps2 = world_from_body * angular_change};
}

glm::dvec3 matter_velocity_mps(const glm::dmat4& world_from_before, const glm::dmat4& world_from_now,
                               const glm::dvec3& point_m, double seconds) {
  if (world_from_now == world_from_before) return glm::dvec3(0);
  const glm::dmat4 now_from_before = world_from_now * glm::inverse(world_from_before);
  if (!is_rigid(now_from_before, kMotionRigidity)) {
    return (point_m - glm::dvec3(glm::inverse(now_from_before) * glm::dvec4(point_m, 1))) / seconds;
  }
  // A frame that stands in the point with the axes of the world: it was at the point's former place, turned back.
  glm::dmat4 frame_now(1.0);
  frame_now[3] = glm::dvec4(point_m, 1);
  const glm::dmat4 frame_before = rigid_inverse(now_from_before) * frame_now;
  return twist_between(frame_before, frame_now, seconds).linear_mps;
}

void PoseHistory::archive(StateArchive& state) {
  state(poses_, count_);
  state.require(count_ <= poses_.size());
  for (std::size_t i = 0; i < std::min(count_, poses_.size()); ++i) {
    state.require_past(poses_[i].time_ns);
    state.require(i == 0 || poses_[i].time_ns < poses_[i - 1].time_ns);
  }
}

}  // namespace simvis
