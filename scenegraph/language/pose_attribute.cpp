#include "scenegraph/language/pose_attribute.h"

#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include <simvis/attributes.h>
#include <simvis/pose.h>

namespace simvis {
namespace {

[[noreturn]] void refuse_pose(const CommandAttribute& attribute, std::string_view seen, const std::string& expected) {
  fail_at(attribute.where, "attribute " + in_quotes(attribute.name) + ": " + std::string(seen) +
                               " is not allowed, expected " + expected);
}

void check_position(const CommandAttribute& attribute, std::span<const double> position_m) {
  for (const double coordinate : position_m) {
    if (std::abs(coordinate) <= kMaxCoordinate_m) continue;
    refuse_pose(attribute, format_number(coordinate),
                "x y z from " + format_number(-kMaxCoordinate_m) + " to " + format_number(kMaxCoordinate_m) + " (m)");
  }
}

// The position, where another attribute gives the orientation.
glm::dvec3 position_only(const CommandAttribute& attribute, std::string_view orientation) {
  std::array<double, 3> v{};
  if (!parse_numbers(attribute.value, v)) {
    refuse_pose(attribute, in_quotes(attribute.value),
                "three finite numbers x y z (m), since " + in_quotes(orientation) + " gives the orientation");
  }
  check_position(attribute, v);
  return {v[0], v[1], v[2]};
}

glm::dmat4 rotation_of(const CommandAttribute& attribute) {
  std::array<double, 4> v{};
  if (!parse_numbers(attribute.value, v)) {
    refuse_pose(attribute, in_quotes(attribute.value), "four finite numbers w x y z");
  }
  const glm::dquat quaternion(v[0], v[1], v[2], v[3]);
  const double length = glm::length(quaternion);
  if (!(std::abs(length - 1) <= kQuaternionTolerance)) {
    refuse_pose(attribute, in_quotes(attribute.value),
                "w x y z of length 1 within " + format_number(kQuaternionTolerance) + ", and this has length " +
                    format_number(length));
  }
  return glm::mat4_cast(quaternion / length);
}

}  // namespace

std::optional<glm::dmat4> pose_offset(const Command& command) {
  const CommandAttribute* const attribute = command.find(kPoseOffset);
  const CommandAttribute* const quaternion = command.find(kQuaternion);
  const CommandAttribute* const look_at = command.find(kLookAt);
  if (quaternion != nullptr && look_at != nullptr) {
    fail_at(look_at->where,
            "attribute \"look_at\": the attribute \"quaternion\" gives an orientation already, expected "
            "one of them");
  }
  if (quaternion != nullptr || look_at != nullptr) {
    glm::dmat4 matrix = quaternion != nullptr ? rotation_of(*quaternion) : glm::dmat4(1);
    const std::string_view orientation = quaternion != nullptr ? kQuaternion : kLookAt;
    if (attribute != nullptr) matrix[3] = glm::dvec4(position_only(*attribute, orientation), 1);
    return matrix;
  }
  if (attribute == nullptr) return std::nullopt;
  std::array<double, 6> v{};
  if (!parse_numbers(attribute->value, v)) {
    refuse_pose(*attribute, in_quotes(attribute->value), "six finite numbers: x y z (m) roll pitch yaw (deg)");
  }
  check_position(*attribute, std::span(v).first(3));
  return matrix_from_degrees({v[0], v[1], v[2]}, v[3], v[4], v[5]);
}

}  // namespace simvis
