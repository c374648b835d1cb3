// The rows of a pose in attribute tables: x, y, z, roll, pitch and yaw, all live.
#pragma once

#include <glm/glm.hpp>

#include <simvis/attributes.h>
#include <simvis/element.h>
#include <simvis/pose.h>

namespace simvis {

constexpr AttributeSpec pose_length(std::string_view name, std::string_view text) {
  return {.name = name,
          .kind = AttributeKind::number,
          .default_value = "0",
          .unit = "m",
          .text = text,
          .min = -kMaxCoordinate_m,
          .max = kMaxCoordinate_m,
          .live = true};
}

constexpr AttributeSpec pose_angle(std::string_view name, std::string_view text) {
  return {.name = name,
          .kind = AttributeKind::number,
          .default_value = "0",
          .unit = "deg",
          .text = text,
          .live = true,
          .full_turn = true};
}

inline constexpr AttributeSpec kPoseX = pose_length("x", "forward"), kPoseY = pose_length("y", "to the left"),
                               kPoseZ = pose_length("z", "up"), kPoseRoll = pose_angle("roll", "turn about x, first"),
                               kPosePitch = pose_angle("pitch", "turn about y, second; positive is nose down"),
                               kPoseYaw = pose_angle("yaw", "turn about z, last; positive is to the left");
inline constexpr std::size_t kPoseValues = 6;

/// The matrix of the values of these rows, in their order, which come first.
inline glm::dmat4 matrix_of_pose(ParameterView values) {
  return matrix_from_degrees({values[0], values[1], values[2]}, values[3], values[4], values[5]);
}

/// The values of a rigid matrix.
void write_pose(const glm::dmat4& rigid, std::span<double> values);

}  // namespace simvis
