// The splats of a draw list as one viewpoint sees them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include "engine/draw/splat_cloud.h"

namespace simvis {

/// Shares of stopped light below the first count as none, those above the second as the second (the program of Kerbl et
/// al. 2023).
inline constexpr double kMinSplatAlpha = 1.0 / 255, kMaxSplatAlpha = 0.99;

/// A splat whose shortest axis is shorter than this share of the longest one is taken as that thick.
inline constexpr double kFlattestSplat = 1e-7;

/// A splat that can be seen.
///
/// Frames   V = the view frame: x right, y down, z forward. S = the splat's own: its centre is the origin, and its
///          standard deviation is 1 along each axis.
struct SeenSplat {
  glm::dmat3 splat_from_view{1.0};  ///< S from V, of directions
  glm::dvec3 camera{0};             ///< S: the origin of V
  glm::dvec3 center_m{0};           ///< V
  glm::mat3 half_axes_m{0};         ///< V: those of the ellipsoid outside of which it is not seen; the longest is first
  double square_reach = 0;          ///< S: the square of the ellipsoid's radius
  double nearest_m = 0;             ///< at most the range of each point of the ellipsoid
  double opacity = 0;
  glm::vec3 color{0};  ///< of its encoding
  SplatEncoding encoding = SplatEncoding::srgb;
  std::uint32_t item = 0;  ///< in DrawList::items
};

/// The point of a ray at which the Gaussian of a splat is largest.
struct SplatPeak {
  double range_m = 0;
  double square_distance = 0;  ///< S: from the centre
};

/// The peak along the whole line through the origin of V along (x, y, z) (V, unit length). The splat counts with its
/// value there, as Moenne-Loccoz et al. 2024 evaluate it. This holds for every lens and every resolution, where the
/// projection of Kerbl et al. 2023 is exact for small splats near the axis of a pinhole alone.
inline SplatPeak peak_along(const SeenSplat& splat, double x, double y, double z) {
  const glm::dmat3& m = splat.splat_from_view;
  const glm::dvec3& c = splat.camera;
  const double u = m[0].x * x + m[1].x * y + m[2].x * z, v = m[0].y * x + m[1].y * y + m[2].y * z,
               w = m[0].z * x + m[1].z * y + m[2].z * z;
  const double a = c.y * w - c.z * v, b = c.z * u - c.x * w, d = c.x * v - c.y * u;
  const double square = u * u + v * v + w * w;
  return {-(c.x * u + c.y * v + c.z * w) / square, (a * a + b * b + d * d) / square};
}

/// The share of the light that a splat of this opacity stops at this distance from its centre, 0 included.
inline double splat_alpha(double opacity, double square_distance) {
  const double alpha = opacity * std::exp(-square_distance / 2);
  return alpha < kMinSplatAlpha ? 0 : std::min(alpha, kMaxSplatAlpha);
}
/// The same.
inline double alpha_at(const SeenSplat& splat, double square_distance) {
  return splat_alpha(splat.opacity, square_distance);
}

/// The axes of a splat in the frame of its mesh: columns of unit length.
glm::dmat3 splat_rotation(const Splat& splat);
/// Its standard deviations along these axes, none of which is too short: see kFlattestSplat.
glm::dvec3 splat_sigma(const Splat& splat);
/// The square of the distance in standard deviations beyond which it stops no light.
inline double splat_square_reach(const Splat& splat) {
  return 2 * std::log(static_cast<double>(splat.opacity) / kMinSplatAlpha);
}

/// Whether a visible item of the list has splats.
bool has_splats(const DrawList& list);

/// The splats of the visible items, in the order of the list. Items of `places`, in the order of the list, are
/// elsewhere. `world_from_view` is rigid. Splats that are nowhere visible are left out.
std::vector<SeenSplat> see_splats(const DrawList& list, const glm::dmat4& world_from_view,
                                  std::span<const ItemPlace> places);

}  // namespace simvis
