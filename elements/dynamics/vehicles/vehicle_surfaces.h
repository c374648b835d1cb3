// Wheels with rollers and tracks of a vehicle: parts of its body whose surfaces move while their shapes stay.
//
// A wheel with rollers transmits forces along the axis a of the roller that touches the floor, and none across it. With
// the velocity v and the rate of turning w of the vehicle, a wheel at p that drives along d at the speed s does not
// slip if a . (v + w x p - s d) = 0. A track at p transmits forces along all directions; without slip, d . (v + w x p)
// = s.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "elements/command_source.h"
#include "elements/dynamics/world/world.h"

namespace simvis {

/// In the frame of the vehicle's part.
struct VehicleSurface {
  std::string_view parameter;               ///< of its speed
  CollisionShape shape;                     ///< a ball or a box that stands on z = 0
  glm::dvec3 place_m{0};                    ///< where it touches the floor; of a track the middle
  glm::dvec3 drive{1, 0, 0};                ///< unit length: where its speed drives the vehicle
  std::optional<glm::dvec3> roller_axis{};  ///< unit length; none: it has no rollers

  SurfaceMotion motion(double speed_m_s) const;
  /// The speed without slip, in m/s.
  double speed_of(const VelocityCommand& command) const;
};

/// Balls at the corners of a rectangle from x = `axle_m` to `axle_m` + `wheelbase_m`. The roller that touches the floor
/// has the axis (1, -1, 0) / sqrt(2) at front left and rear right, (1, 1, 0) / sqrt(2) at front right and rear left.
std::vector<VehicleSurface> mecanum_wheels(double axle_m, double wheelbase_m, double track_m, double radius_m);

/// Three balls on a circle around x = `axle_m`, the first at 60 degrees, the others 120 degrees apart to the left. They
/// drive along the circle, and their rollers let them move across it.
std::vector<VehicleSurface> omni_wheels(double axle_m, double circle_m, double radius_m);

/// Two boxes from x = `axle_m` to `axle_m` + `wheelbase_m`, twice as high as the radius.
std::vector<VehicleSurface> tracks(double axle_m, double wheelbase_m, double track_m, double width_m, double radius_m);

}  // namespace simvis
