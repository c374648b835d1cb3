// Messages from simulated times and poses.
//
// Frames   bodies and sensors: x forward, y left, z up (REP 103). The world is by default the frame kWorldFrame (REP
//          105).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>

#include "exchange/messages/types/geometry_types.h"

namespace simvis::ros {

inline constexpr std::string_view kWorldFrame = "map";

/// The variance of what a sensor does not measure, on the diagonal of a covariance: one that no filter trusts, as
/// drivers of robots give it.
inline constexpr double kUnmeasured = 1e6;

/// A simulated time and the pose at it. The pose is rigid.
struct PoseAt {
  std::int64_t time_ns = 0;
  glm::dmat4 world_from_body{1.0};
};

Time to_time(std::int64_t time_ns);
Header header_of(std::int64_t time_ns, std::string_view frame_id);
Transform to_transform(const glm::dmat4& rigid);

PoseStamped pose_stamped(const PoseAt& pose, const std::string& world_frame);

/// The mean velocity between two times, of which `after` is later, in the body's frame at the later one.
Twist mean_twist(const PoseAt& before, const PoseAt& after);

Odometry odometry(const PoseAt& before, const PoseAt& after, const std::string& world_frame,
                  const std::string& body_frame);

/// An odometry of another frame of the same rigid body, at which the odometry's own frame stands at `body_from_own`:
/// pose, twist and both covariances. The pose stays in the frame of the header. Directions of the variance kUnmeasured
/// are turned with the axes; over the distance between the origins, only what was measured is carried.
Odometry of_body(const Odometry& own, const glm::dmat4& body_from_own, const std::string& body_frame);

}  // namespace simvis::ros
