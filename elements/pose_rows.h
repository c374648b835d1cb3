// The rows of a pose in attribute tables: x, y, z, roll, pitch and yaw, all live.
#pragma once

#include <glm/glm.hpp>
#include <iterator>
#include <vector>

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

inline constexpr AttributeSpec kPoseRows[] = {pose_length("x", "forward"),
                                              pose_length("y", "to the left"),
                                              pose_length("z", "up"),
                                              pose_angle("roll", "turn about x, first"),
                                              pose_angle("pitch", "turn about y, second; positive is nose down"),
                                              pose_angle("yaw", "turn about z, last; positive is to the left")};
inline constexpr std::size_t kPoseValues = std::size(kPoseRows);

/// The rows of a pose. A table gets them by join_tables().
inline std::vector<AttributeSpec> pose_rows() { return {std::begin(kPoseRows), std::end(kPoseRows)}; }

/// The matrix of the values of these rows, in their order, which come first.
inline glm::dmat4 matrix_of_pose(ParameterView values) {
  return matrix_from_degrees({values[0], values[1], values[2]}, values[3], values[4], values[5]);
}

/// The values of a rigid matrix.
void write_pose(const glm::dmat4& rigid, std::span<double> values);

}  // namespace simvis
