// Rays through the centres of a camera's pixels: the surface that each pixel sees, exact up to the rounding of double.
//
// The rays see what a rendered pixel would show if it were one point: see surface_rays.h, with nothing nearer than
// `near`.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/camera_layout.h>
#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include <simvis/ray_caster.h>
#include "sensors/camera/camera_views.h"
#include "sensors/camera/moved_world.h"
#include "sensors/camera/surface_rays.h"

namespace simvis {

/// Rows of an image that are taken at the same time.
struct PixelRows {
  std::uint32_t first = 0, count = 0;
  glm::dmat4 world_from_view{1.0};      ///< V, rigid
  std::span<const ItemPlace> places{};  ///< items that are elsewhere at that time, see View::places
};

/// Calls action(pixel) for all pixels of `count` rows of an image of this width, tile by tile: a packet of rays (see
/// RayCaster::kPacketSize) through pixels that follow each other stays close together.
template <typename Action>
void for_tiled_pixels(std::uint32_t first, std::uint32_t count, std::uint32_t width_px, const Action& action) {
  constexpr std::uint32_t kTileWidth = 8, kTileHeight = RayCaster::kPacketSize / kTileWidth;
  for (std::uint32_t top = first; top < first + count; top += kTileHeight) {
    const std::uint32_t bottom = std::min(top + kTileHeight, first + count);
    for (std::uint32_t left = 0; left < width_px; left += kTileWidth) {
      const std::uint32_t right = std::min(left + kTileWidth, width_px);
      for (std::uint32_t y = top; y < bottom; ++y) {
        for (std::uint32_t x = left; x < right; ++x) action(y * width_px + x);
      }
    }
  }
}

class PixelRays {
 public:
  /// `views` are those of the layout. `near_m` is along the axis of the view that has the pixel.
  PixelRays(const CameraLayout& layout, const CameraViews& views, double near_m);

  /// The ray of each pixel, [y * width + x]: V, unit length; zero: the pixel sees nothing.
  const std::vector<glm::dvec3>& directions() const { return directions_; }

  /// What is nearer along the pixel's ray is not seen.
  double near_range_m(std::uint32_t pixel) const { return near_range_m_[pixel]; }
  const std::vector<double>& near_ranges_m() const { return near_range_m_; }

  /// Starts an image of this list, which must live until its last cast().
  void begin(const DrawList& list);

  /// Sets seen[i] for each pixel i of the rows that sees something, or only for `pixels` of these rows. `caster`'s
  /// world is the list of begin(). Rows that have places have the same items.
  void cast(RayCaster& caster, const PixelRows& rows, std::span<SeenSurface> seen);
  void cast(RayCaster& caster, const PixelRows& rows, std::span<const std::uint32_t> pixels,
            std::span<SeenSurface> seen);

  /// Number of rays since it was made.
  std::uint64_t rays() const { return rays_.rays(); }
  /// Draw lists copied since it was made, because items were elsewhere.
  std::uint64_t lists_copied() const { return moved_.copies(); }

 private:
  void choose_pixels(const PixelRows& rows);

  std::uint32_t width_px_;
  std::vector<glm::dvec3> directions_;
  std::vector<double> near_range_m_;         // of each pixel, along its ray
  std::vector<std::uint32_t> chosen_;        // the pixels of some rows
  std::vector<glm::dvec3> cast_directions_;  // by the pixels that are cast, as behind_m_ and met_
  std::vector<double> behind_m_;
  std::vector<SeenSurface> met_;
  const DrawList* list_ = nullptr;
  MovedWorld moved_;
  SurfaceRays rays_;
};

}  // namespace simvis
