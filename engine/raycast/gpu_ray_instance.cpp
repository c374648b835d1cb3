#include "engine/raycast/gpu_ray_instance.h"

#include <cmath>

namespace simvis {

namespace {

constexpr double kUlp = 0x1p-23;  // ulp of a float32, relative
constexpr double kBlockUnit = 0x1p-53;

// Covers the rounding of these bounds themselves to float32.
constexpr double kRoundedUp = 1.001;

struct HighLow {
  glm::vec4 high, low;
  explicit HighLow(const glm::dvec3& place)
      : high(glm::vec3(place), 0), low(glm::vec3(place - glm::dvec3(glm::vec3(place))), 0) {}
};

}  // namespace

shader::GpuRayInstance block_of(const RayInstance& item, const glm::dvec3& origin, const GpuRayInstanceTree& tree) {
  const glm::dmat3 linear(item.world_from_mesh), inverse = glm::inverse(linear);
  const glm::dvec3 centre = glm::dvec3(item.world_from_mesh[3]) - origin + linear * item.mesh->centre();
  const double condition = frobenius(linear) * frobenius(inverse);
  const double inverse_error = condition * (frobenius(linear * inverse - glm::dmat3(1.0)) + 4 * kBlockUnit * condition);
  const double stretch = frobenius(inverse) / item.mesh->radius(), scale = stretch / std::sqrt(3.0);
  const double lengths_m = frobenius(linear) * (glm::length(item.mesh->centre()) + item.mesh->radius()) +
                           glm::length(centre) + 2 * RayInstances::kReach_m;
  const double slack = kUlp * (24 * condition + 45) + 6 * inverse_error + 0x1p-44 * lengths_m * stretch;
  const double slack_per_unit = kUlp * (11 * condition + 8) + 2 * inverse_error;
  constexpr double kMinScale = 1e-18;  // float32 can just square this value and its inverse
  const bool placed = slack + slack_per_unit <= SIMVIS_MAX_SLACK && scale >= kMinScale && scale <= 1 / kMinScale;
  shader::GpuRayInstance block{};
  const bool by_host = !placed || item.mesh->by_host();
  block.tree.w = !item.visible ? SIMVIS_HIDDEN_ITEM : by_host ? SIMVIS_ITEM_OF_HOST : 0;
  if (block.tree.w != 0) return block;
  const glm::dmat3 rows = glm::transpose(inverse) / (item.mesh->radius() * scale);
  const HighLow place(centre);
  block.row_x = glm::dvec4(rows[0], scale);
  block.row_y = glm::dvec4(rows[1], kRoundedUp * slack);
  block.row_z = glm::dvec4(rows[2], kRoundedUp * slack_per_unit);
  block.centre_high = {glm::vec3(place.high), kRoundedUp * (kUlp * (4 * condition + 16) + inverse_error)};
  block.centre_low = place.low;
  block.tree = {tree.root, tree.first_triangle, (tree.solid ? 1u : 0u) + (tree.has_back ? 2u : 0u), 0};
  return block;
}

shader::RayCastBlock block_of(const glm::dvec3& world_sensor, const glm::dvec3& origin, std::uint32_t rays,
                              HitSides sides) {
  const HighLow sensor(world_sensor - origin);
  return {.sensor_high = sensor.high, .sensor_low = sensor.low, .rays = {rays, sides == HitSides::front, 0, 0}};
}

}  // namespace simvis
