#include "simvis/look_at.h"

#include <array>
#include <cmath>
#include <optional>

#include <simvis/attributes.h>
#include "scenegraph/language/pose_attribute.h"

namespace simvis {
namespace {

[[noreturn]] void refuse_target(const CommandAttribute& target, const std::string& why) {
  fail_at(target.where, "attribute \"look_at\": " + in_quotes(target.value) + why);
}

glm::dmat4 frame_of(const Scene& scene, const std::string& point, const CommandAttribute& target) {
  const std::optional<glm::dmat4> world_from_point = scene.world_from_point(point);
  if (!world_from_point) refuse_target(target, ": " + in_quotes(point) + " stands in a part that is switched off");
  return *world_from_point;
}

glm::dvec3 find_target(const Scene& scene, const CommandAttribute& target, const glm::dmat4& world_from_parent) {
  std::array<double, 3> v{};
  if (parse_numbers(target.value, v)) return world_from_parent * glm::dvec4(v[0], v[1], v[2], 1);
  if (const std::optional<std::uint32_t> object = scene.objects().find(target.value)) {
    return frame_of(scene, scene.objects()[*object].name, target)[3];
  }
  fail_at(target.where, "attribute \"look_at\": " + scene.objects().unknown("part or link", target.value) +
                            ", expected x y z (m) or the name of a part inserted before");
}

}  // namespace

glm::dmat4 look_at_offset(const Scene& scene, const Command& sensor, const glm::dvec3& position_m) {
  const CommandAttribute& target = sensor.require(kLookAt);
  const CommandAttribute& insert_at = sensor.require("insert_at");
  if (!scene.has_insertion_point(insert_at.value)) return glm::dmat4(1);  // the insertion reports it
  const glm::dmat4 world_from_parent = frame_of(scene, insert_at.value, target);
  const glm::dvec3 eye(world_from_parent * glm::dvec4(position_m, 1));
  const glm::dvec3 way = find_target(scene, target, world_from_parent) - eye;
  const double distance_m = glm::length(way);
  if (!(distance_m >= kMinLookDistance_m && std::isfinite(distance_m))) {
    refuse_target(target, " is where the sensor stands, expected a target at least " +
                              format_number(kMinLookDistance_m) + " m away");
  }
  const glm::dvec3 x = way / distance_m, up(0, 0, 1);
  glm::dvec3 z = up - glm::dot(up, x) * x;
  if (!(glm::length(z) >= kMinLookSine)) {
    refuse_target(target,
                  " is straight above or below the sensor, so that no side of it is up; expected another target "
                  "or an orientation in \"pose_offset\"");
  }
  z = glm::normalize(z);
  const glm::dmat3 parent(world_from_parent), world_from_sensor(x, glm::cross(z, x), z);
  const double volume = std::abs(glm::determinant(parent));
  if (!(volume > 0 && std::isfinite(volume))) refuse_target(target, ": the frame of the sensor is scaled to nothing");
  glm::dmat4 offset(glm::inverse(parent) * world_from_sensor);
  offset[3] = glm::dvec4(position_m, 1);
  return offset;
}

}  // namespace simvis
