#include "elements/dynamics/hand_pulls.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <simvis/attributes.h>
#include <simvis/error.h>
#include <simvis/pose.h>

namespace simvis {
namespace {

// The spring of a pull. It is critically damped, so that the body follows the hand within half a second and does not
// swing. Its force is at most ten times the weight of the body, so that it lifts the body and does not tear it through
// walls.
constexpr double kPull_rad_s = 8, kMaxPull_m_s2 = 100;

// The forces and torques of a pull are finite for finite coordinates of this size.
void require_coordinates(const glm::dvec3& place_m) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(place_m[axis]) <= kMaxCoordinate_m) continue;
    throw InputError("a place of the pull is out of range, expected x y z from " + format_number(-kMaxCoordinate_m) +
                     " to " + format_number(kMaxCoordinate_m) + " (m)");
  }
}

// Returns the distance of a shape's farthest point from its own origin, or more.
double radius_of(const CollisionShape& shape) {
  switch (shape.kind) {
    case CollisionKind::box:
      return glm::length(shape.half_m);
    case CollisionKind::sphere:
      return shape.half_m.x;
    case CollisionKind::capsule:
    case CollisionKind::cylinder:
      return shape.half_m.x + shape.half_m.z;
    case CollisionKind::hull:
    case CollisionKind::mesh:
    case CollisionKind::plane:
      break;
  }
  double radius = 0;
  for (const glm::dvec3& point : shape.points) radius = std::max(radius, glm::length(point));
  return radius;
}

double reach_of(std::span<const CollisionShape> shapes, const glm::dvec3& center_m) {
  double reach = 0;
  for (const CollisionShape& shape : shapes) {
    reach = std::max(reach, glm::length(glm::dvec3(shape.body_from_shape[3]) - center_m) + radius_of(shape));
  }
  return reach;
}

}  // namespace

void HandPulls::set(std::uint64_t puller, const WorldLink& link, const DynamicParts& parts, const BodyPull& pull) {
  require_coordinates(pull.body_m);
  require_coordinates(pull.target_m);
  const LinkParts own = parts.of_link(link.link);
  // The limit of the arm bounds the torque. It is twice the reach of the shape, because what is drawn may be larger.
  pulls_.insert_or_assign(puller, Pull{.link = link,
                                       .link_m = pull.body_m,
                                       .target_m = pull.target_m,
                                       .mass_kg = parts.moved_mass_kg(),
                                       .reach_m = 2 * reach_of(own.shapes, own.mass->center_m)});
}

void HandPulls::remove_body(std::size_t id) {
  std::erase_if(pulls_, [id](const auto& each) { return each.second.link.id == id; });
}

void HandPulls::act(DynamicsWorld& world) const {
  for (const auto& [puller, pull] : pulls_) {
    const BodyState now = world.state(pull.link);
    glm::dvec3 arm = glm::dvec3(now.world_from_body * glm::dvec4(pull.link_m, 1)) - now.center_m;
    if (const double length = glm::length(arm); length > pull.reach_m) arm *= pull.reach_m / length;
    const glm::dvec3 velocity = now.velocity_m_s + glm::cross(now.angular_velocity_rad_s, arm);
    glm::dvec3 acceleration =
        kPull_rad_s * kPull_rad_s * (pull.target_m - now.center_m - arm) - 2 * kPull_rad_s * velocity;
    if (const double size = glm::length(acceleration); size > kMaxPull_m_s2) acceleration *= kMaxPull_m_s2 / size;
    const auto is_at_body = [id = pull.link.id](const auto& each) { return each.second.link.id == id; };
    const auto sharing = static_cast<double>(std::ranges::count_if(pulls_, is_at_body));
    const glm::dvec3 force = pull.mass_kg / sharing * acceleration;
    world.push(pull.link, {.force_n = force, .torque_nm = glm::cross(arm, force)});
  }
}

}  // namespace simvis
