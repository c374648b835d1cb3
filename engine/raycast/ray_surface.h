// Decides in double where a ray meets an exact shape: see <simvis/exact_surface.h>.
//
// The ray is brought into the frame of the shape, where its points are p(t) = from + t way, with t still the range in
// metres along the ray in the sensor's frame. Every transform that can be inverted therefore keeps the shape exact,
// mirrors and different scales along different axes included.
//
// A closed shape is made of convex pieces: the inside of a quadric, where f(p) <= 0, and a slab between two planes. The
// ray is inside of a piece over one interval of t. A cylinder and a cone are the intersection of two intervals, a
// capsule is the union of three. No ray passes through the rim where two faces meet, since no face is tested by itself.
//
// A quadric gives A s^2 + 2 B s + C <= 0, with s = t - t0, and t0 the range at which the ray is nearest to the middle
// of the quadric. There the coefficients are those of the shape's size and not of its distance, so that B^2 - A C loses
// no digits to the distance. The roots are q / A and C / q with q = -(B + sign(B) sqrt(B^2 - A C)).
//
// Error bound of a crossing (u = 2^-53, g = A s + B half the slope of f, all sums of absolute values):
//   place      A point of the ray is displaced in the shape's frame by at most d_i = |row_i| (k_i u (t + |offset|) + e)
//              along axis i: k_i bounds the error of the inverse and of p(t) (see invert()), e is the error of a corner
//              that is placed in the sensor frame at that distance (see placing_error_m()). This changes f by at most
//              2 sum |p_i w_i| d_i, where w_i are the quadric's coefficients, and by its own square.
//   arithmetic A, B and C round by at most 6 u times the sum of the absolute values of their terms at s, and the root
//              by 4 u of itself, which changes f by at most 8 u times that sum; 16 u are taken.
//   root       If f changes by at most h, then 2 g D + A D^2 = +-h bounds the displacement D of the root: D <= h / |g|
//              where |A| h <= g^2, and D <= 2 sqrt(h / |A|) on rays that graze the surface. It is no longer than the
//              shape: where a ray along a cylinder leaves it far beyond its ends, these ends decide.
//   plane      The height over a plane is off by d + |t| g, see crossing_of_plane(). A ray along a plane has no bound.
//   disc       As a plane, with the height n . (p - m) over the disc with the normal n around m: the displacement and
//              its growth are sums over the axes, weighted by |n_i|, and the sums of products round by at most
//              6 u sum |n_i| (|m_i| + |from_i| + t |way_i|). The true hit is on the disc too, and so is the point at t
//              but for its displacement: the bound is no longer than the disc and that displacement.
//   rim        The entry into an intersection is the latest of the entries into its pieces, and so for their limits.
// As for triangles, which surface a ray hits that passes an outline within the rounding is decided by rounding.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include <simvis/exact_surface.h>
#include "engine/raycast/ray_triangle.h"

namespace simvis {

/// A shape as one sensor sees it.
struct SeenShape {
  const ExactSurface* shape = nullptr;
  /// From the sensor frame to the frame of the shape, whose z axis is the shape's axis: p = (rows[i] . x) + from.
  std::array<glm::dvec3, 3> rows{};
  glm::dvec3 from{0};         ///< the sensor's origin in the frame of the shape
  glm::dvec3 row_lengths{0};  ///< of rows
  glm::dvec3 row_errors{0};   ///< k_i u of the derivation above
  double distance_m = 0;      ///< |offset| of the placement
  double world_error_m = 0;   ///< the part of a point's error that the transforms to the world have; see see_shape()
  /// The centre of a sphere or a disc of a cloud, in the frame of the shape; 0 for all other shapes.
  glm::dvec3 middle{0};
  glm::dvec3 normal{0, 0, 1};  ///< of a disc: that of the vertex, in the frame of the shape, of any length above 0
  double size_m = 0;           ///< no two points of the shape are farther apart; +infinity for a plane
};

/// Empty if the transform flattens the shape, or nearly so, so that its inverse has too few digits: rays then meet the
/// triangles of the mesh. `world_error_m` is that of placing_error.h, for the origins of the mesh and of the sensor.
std::optional<SeenShape> see_shape(const ExactSurface& shape, const MeshPlacement& placement, double world_error_m);

/// From the frame of a mesh to that of its shape, whose z axis is the shape's axis.
inline glm::dvec3 in_shape(const ExactSurface& shape, const glm::dvec3& in_mesh) {
  return {in_mesh[(shape.axis + 1) % 3], in_mesh[(shape.axis + 2) % 3], in_mesh[shape.axis]};
}

/// The same shape as a sensor sees it that is turned alike and stands elsewhere: `offset` is that of its placement.
SeenShape shape_seen_from(SeenShape seen, const glm::dvec3& offset, double world_error_m);

/// A point where a ray enters or leaves a shape.
struct SurfaceHit {
  double range_m = 0, error_bound_m = 0;
  std::uint32_t face = 0;  ///< kRoundFace, kBottomFace or kTopFace
  bool leaves = false;     ///< the ray goes out through the surface there, so that it sees the back; never for a disc
};

/// The hits of a ray in ascending order of range; all ranges are above 0.
struct SurfaceHits {
  std::array<SurfaceHit, 2> at{};
  unsigned count = 0;
};

/// The hit with this range and face, which must be there (asserted).
SurfaceHit find_hit(const SurfaceHits& hits, double range_m, std::uint32_t face);

/// `direction` is a unit vector in the sensor frame. Bounds are 0 unless `with_bounds` is set.
SurfaceHits intersect(const SeenShape& seen, const glm::dvec3& direction, bool with_bounds);

/// The surface at a hit.
struct ShapePoint {
  glm::dvec3 normal{0};         ///< unit length, sensor frame, outwards; of a plane along its axis, of a disc along its
                                ///< normal
  double normal_error_rad = 0;  ///< largest rotation of the normal by rounding
};
ShapePoint shape_point(const SeenShape& seen, const glm::dvec3& direction, const SurfaceHit& hit);

/// The texture coordinates at a hit, as those of the mesh: of set 0 or 1.
glm::dvec2 shape_uv(const SeenShape& seen, const glm::dvec3& direction, double range_m, std::uint32_t face, int set);

}  // namespace simvis
