// The exact shape that a mesh stands for: a sphere is drawn as a polyhedron, and rays meet the sphere.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

namespace simvis {

/// The shapes that rays meet exactly.
enum class SurfaceKind : std::uint8_t {
  sphere,    ///< around the origin
  cylinder,  ///< closed, centred at the origin
  cone,      ///< closed, its tip up, its axis centred at the origin
  capsule,   ///< a cylinder with a half sphere at each end, centred at the origin
  plane,     ///< through the origin, perpendicular to the axis
  disc       ///< of the points of a cloud alone: around the origin, perpendicular to the normal of the point's vertex,
             ///< without thickness
};

/// A shape in the frame of its mesh.
///
/// Units    metres, before the transform of the item.
/// Range    lengths are above 0 and finite, except those of a plane.
struct ExactSurface {
  SurfaceKind kind = SurfaceKind::sphere;  ///< which shape it is
  int axis = 2;                            ///< of the mesh frame: 0 x, 1 y, 2 z; "up" is its positive direction
  double radius_m = 0,                     ///< of all but a plane; of a cone's base; of a disc in the mesh's frame
      length_m = 0;                        ///< along the axis, of a cylinder, a cone, or a capsule without its ends
  double deviation_m =
      0;  ///< no point of the shape is farther from the drawn mesh; a plane's drawn part has no deviation
  /// Of a plane: half its lengths along the two axes that follow `axis` in cyclic order; +infinity: without end.
  glm::dvec2 half_size_m{std::numeric_limits<double>::infinity()};
  glm::dvec2 drawn_m{1};  ///< of a plane: the lengths of its mesh, over which its texture extends once

  bool operator==(const ExactSurface&) const = default;  ///< member by member
};

/// The faces of a shape: rays give them as the primitive that they hit.
inline constexpr std::uint32_t kRoundFace = 0,  ///< the round side; the plane; the disc
    kBottomFace = 1,                            ///< the lower disc of a cylinder or a cone
    kTopFace = 2;                               ///< the upper disc of a cylinder

}  // namespace simvis
