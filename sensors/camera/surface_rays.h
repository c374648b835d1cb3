// Rays that see what a camera sees: no back faces of single-sided materials (see HitSides), nothing nearer than a given
// range, and of transparent surfaces those that are depth-visible. Lines and points have no surface, so no ray sees
// them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/frame_results.h>
#include <simvis/ray_caster.h>

namespace simvis {

/// The surface that a ray of a camera sees.
///
/// Frames   V = view frame of the camera at the time of the pixel's row: x right, y down, z forward.
struct SeenSurface {
  std::uint32_t item = kNoItem;  ///< in DrawList::items; kNoItem: nothing is seen, and no other member is set
  std::uint32_t primitive = 0;   ///< as in RayHit
  double range_m = std::numeric_limits<double>::infinity();  ///< along the ray
  double error_bound_m = 0;                                  ///< of the range
  glm::dvec3 normal{0};                                      ///< V, unit length, towards the camera
};

class SurfaceRays {
 public:
  /// Sets seen[i] to what the ray along directions[i] (V, unit length) sees behind the range behind_m[i]. `caster`'s
  /// world is `list`. Neighbouring rays should follow each other, see RayCaster::kPacketSize.
  void cast(RayCaster& caster, const DrawList& list, const glm::dmat4& world_from_view,
            std::span<const glm::dvec3> directions, std::span<const double> behind_m, std::span<SeenSurface> seen);

  /// Number of rays since it was made.
  std::uint64_t rays() const { return rays_; }

 private:
  std::vector<RayHit> hits_;
  std::uint64_t rays_ = 0;
};

}  // namespace simvis
