#include "elements/dynamics/vehicles/vehicle_surfaces.h"

#include <cmath>
#include <numbers>

namespace simvis {
namespace {

constexpr glm::dvec3 kUp{0, 0, 1};

CollisionShape shape_at(const glm::dvec3& place_m, CollisionKind kind, const glm::dvec3& half_m) {
  CollisionShape shape{.kind = kind, .half_m = half_m};
  shape.body_from_shape[3] = glm::dvec4(place_m + half_m.z * kUp, 1);
  return shape;
}

}  // namespace

// The lower side of the surface runs against the direction of the drive.
SurfaceMotion VehicleSurface::motion(double speed_m_s) const {
  return {.belt_m_s = speed_m_s * glm::cross(kUp, drive), .roller_axis = roller_axis};
}

double VehicleSurface::speed_of(const VelocityCommand& command) const {
  const glm::dvec3 velocity_m_s =
      glm::dvec3(command.forward_m_s, command.left_m_s, 0) + command.turn_rad_s * glm::cross(kUp, place_m);
  const glm::dvec3 grip = roller_axis.value_or(drive);
  return glm::dot(grip, velocity_m_s) / glm::dot(grip, drive);
}

std::vector<VehicleSurface> mecanum_wheels(double axle_m, double wheelbase_m, double track_m, double radius_m) {
  struct Corner {
    std::string_view parameter;
    double front, left;
  };
  std::vector<VehicleSurface> wheels;
  for (const Corner& corner : {Corner{"front_left", 1, 1}, Corner{"front_right", 1, -1}, Corner{"rear_left", 0, 1},
                               Corner{"rear_right", 0, -1}}) {
    const glm::dvec3 place(axle_m + corner.front * wheelbase_m, corner.left * track_m / 2, 0);
    const double side = corner.front > 0 ? -corner.left : corner.left;
    wheels.push_back({.parameter = corner.parameter,
                      .shape = shape_at(place, CollisionKind::sphere, glm::dvec3(radius_m)),
                      .place_m = place,
                      .roller_axis = glm::dvec3(1, side, 0) / std::numbers::sqrt2});
  }
  return wheels;
}

std::vector<VehicleSurface> omni_wheels(double axle_m, double circle_m, double radius_m) {
  std::vector<VehicleSurface> wheels;
  for (const std::string_view parameter : {"wheel_1", "wheel_2", "wheel_3"}) {
    const double angle = std::numbers::pi * (1.0 + 2.0 * static_cast<double>(wheels.size())) / 3;
    const glm::dvec3 arm(std::cos(angle), std::sin(angle), 0), place = glm::dvec3(axle_m, 0, 0) + circle_m * arm;
    const glm::dvec3 along = glm::cross(kUp, arm);
    wheels.push_back({.parameter = parameter,
                      .shape = shape_at(place, CollisionKind::sphere, glm::dvec3(radius_m)),
                      .place_m = place,
                      .drive = along,
                      .roller_axis = along});
  }
  return wheels;
}

std::vector<VehicleSurface> tracks(double axle_m, double wheelbase_m, double track_m, double width_m, double radius_m) {
  std::vector<VehicleSurface> both;
  for (const std::string_view parameter : {"left", "right"}) {
    const glm::dvec3 place(axle_m + wheelbase_m / 2, (parameter == "left" ? track_m : -track_m) / 2, 0);
    both.push_back({.parameter = parameter,
                    .shape = shape_at(place, CollisionKind::box, glm::dvec3(wheelbase_m, width_m, 2 * radius_m) / 2.0),
                    .place_m = place});
  }
  return both;
}

}  // namespace simvis
