// Walls along a polyline, with doors and windows.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// A rectangular hole through a wall.
struct WallOpening {
  double at_m = 0;      ///< of its middle, along the polyline from the first point
  double width_m = 0;   ///< along the polyline
  double sill_m = 0;    ///< height of its lower edge; 0: a door
  double height_m = 0;  ///< from its lower to its upper edge
};

/// A wall whose middle plane stands on the polyline, from z = 0 up. At corners the sides of the two pieces meet. If the
/// last point is the first one, the wall is closed.
struct WallPlan {
  std::vector<glm::dvec2> points;
  double height_m = 0, thickness_m = 0;
  std::vector<WallOpening> openings;
};

/// What of a plan is wrong.
struct WallError {
  enum class Of { points, openings } of;
  std::size_t index;  ///< of the opening
  std::string what;
};

/// Checks a plan of at least two points and of positive sizes: points that coincide, corners that are too sharp or too
/// near to each other for the thickness, openings that are not within one straight piece of the wall, that overlap, or
/// that are higher than the wall.
std::optional<WallError> check_wall(const WallPlan& plan);

/// The closed surface of a checked plan, with flat normals. A texture covers a square as wide as the wall is high.
Mesh wall_mesh(const WallPlan& plan);

}  // namespace simvis
