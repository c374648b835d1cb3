// Rays through the centres of a camera's pixels: the surface that each pixel sees, exact up to the rounding of double.
//
// The rays see what a rendered pixel would show if it were one point: no back faces of single-sided materials, nothing
// nearer than `near`, and of transparent surfaces those that are depth-visible. A back face is passed over by casting
// the ray again from behind it. Lines and points have no surface, so no ray sees them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include <simvis/camera_layout.h>
#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/ray_caster.h>
#include "sensors/camera/camera_views.h"

namespace simvis {

/// The surface at the centre of a pixel.
///
/// Frames   V = view frame of the camera at the time of the pixel's row: x right, y down, z forward.
struct SeenSurface {
  std::uint32_t item = kNoItem;  ///< in DrawList::items; kNoItem: nothing is seen, and only the range is set
  double range_m = std::numeric_limits<double>::infinity();  ///< along the ray
  double error_bound_m = 0;                                  ///< of the range
  glm::dvec3 normal{0};                                      ///< V, unit length, towards the camera
};

/// Rows of an image that are taken at the same time.
struct PixelRows {
  std::uint32_t first = 0, count = 0;
  glm::dmat4 world_from_view{1.0};      ///< V, rigid
  std::span<const ItemPlace> places{};  ///< items that are elsewhere at that time, see View::places
};

class PixelRays {
 public:
  /// `views` are those of the layout. `near_m` is along the axis of the view that has the pixel.
  PixelRays(const CameraLayout& layout, const CameraViews& views, double near_m);
  /// An image of one row. `near_range_m[i]` is along directions[i], which are as directions().
  PixelRays(std::vector<glm::dvec3> directions, std::vector<double> near_range_m);

  /// The ray of each pixel, [y * width + x]: V, unit length; zero: the pixel sees nothing.
  const std::vector<glm::dvec3>& directions() const { return directions_; }

  /// Sets seen[i] for each pixel i of the rows. `caster`'s world is `list`.
  void cast(RayCaster& caster, const DrawList& list, const PixelRows& rows, std::span<SeenSurface> seen);

  /// Number of rays since it was made.
  std::uint64_t rays() const { return rays_cast_; }

 private:
  const DrawList& move(const DrawList& list, std::span<const ItemPlace> places);
  void choose_pixels(const PixelRows& rows);
  void cast_chosen(RayCaster& caster, const glm::dmat4& world_from_view);
  void read_hits(const DrawList& list, const glm::dmat4& world_from_view, std::span<SeenSurface> seen);

  std::uint32_t width_px_;
  std::vector<glm::dvec3> directions_;
  std::vector<double> near_range_m_;   // of each pixel, along its ray
  std::vector<std::uint32_t> chosen_;  // pixels of the rays that are cast now
  std::vector<double> behind_m_;       // by chosen pixel
  std::vector<glm::dvec3> cast_directions_;
  std::vector<RayHit> hits_;  // by chosen pixel
  DrawList moved_list_;
  std::unique_ptr<RayCaster> moved_caster_;  // null until something has moved
  std::uint64_t rays_cast_ = 0;
};

}  // namespace simvis
