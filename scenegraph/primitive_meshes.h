// Meshes of simple shapes, counter-clockwise seen from outside, with texture coordinates 0..1 on every side. All but
// the planes are closed. Those of round shapes and of planes without end have the exact shape as their `surface`, which
// rays meet. What a view draws of a round shape are flat sides, as many as its picture needs: see
// engine/geometry/round_levels.h. These meshes have kSidesAround.
#pragma once

#include <glm/glm.hpp>

#include <simvis/mesh.h>
#include "engine/draw/round_mesh.h"

namespace simvis {

/// A box with flat normals, centred at the origin. `size_m` is along x, y, z and above 0. Half of it is rounded to
/// float32. Pictures stand upright on its four sides; on its top up is +y, and below +x.
Mesh box_mesh(const glm::dvec3& size_m);

/// The transform, in double, that gives box_mesh() that size without the rounding to float32: it scales along x, y and
/// z, by 1 where nothing was rounded, or where float32 has no such
/// number.
glm::dmat4 exact_box_scale(const glm::dvec3& size_m);

/// A cylinder along z, centred at the origin. Its normals are smooth around the axis and flat at the ends.
Mesh cylinder_mesh(double radius_m, double length_m);

/// A cone along z with its tip up, its axis centred at the origin. Its normals are smooth around the axis.
Mesh cone_mesh(double radius_m, double length_m);

/// A sphere with smooth normals, centred at the origin.
Mesh sphere_mesh(double radius_m);

/// A cylinder along z with a half sphere at each end, centred at the origin. `length_m` is that of the cylinder, so the
/// whole is length_m + 2 radius_m long. Its normals are smooth.
Mesh capsule_mesh(double radius_m, double length_m);

/// A rectangle in the plane z = 0 that faces +z, centred at the origin. `size_m` is along x and y.
Mesh plane_mesh(const glm::dvec2& size_m);

/// The length that is drawn of a plane without end.
inline constexpr double kDrawnPlane_m = 100;

/// The same, without end along each axis whose half size is +infinity. Of such an axis kDrawnPlane_m is drawn.
Mesh endless_plane_mesh(const glm::dvec2& half_size_m);

}  // namespace simvis
