// The pinhole views that a camera renders, and how its pixels are interpolated from them. Pure geometry, computed once,
// in double precision.
//
// Direct     An image without rays of its own is one pinhole view or, with a row time, one view for each group of rows
//            that share a pose. The pixels of the views are the pixels of the image.
// Resampled  An image with rays is covered, for each group of rows, by one view along the optical axis if that view has
//            at most kMaxSpread times the image's pixels. Otherwise it is covered by up to six views along the axes of
//            a cube, each for the rays that are nearest to its axis. All views have `oversampling` times the image's
//            focal length. They are cropped to the pixels that are used and their neighbourhoods, including neighbours
//            beyond the border to another view. A pixel is therefore interpolated within one view, from pixels that do
//            not depend on the position of the border, and there is no seam.
//            Each pixel is interpolated at one point: an image that is much coarser than its views aliases, as an image
//            that is rendered directly does.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/frame_plan.h>
#include "sensors/raster_depth/beam_tap.h"

namespace simvis {

/// The largest ratio of the pixels of one view to the pixels of the image; above it the views of a cube are used.
inline constexpr double kMaxSpread = 4;

/// Frames   F = the view's own frame, V = the camera's; both x right, y down, z forward.
struct CameraView {
  glm::dmat3 face_from_view{1.0};  ///< F from V
  Pinhole pinhole;
  std::size_t pass = 0;
  std::uint32_t x_px = 0, y_px = 0, width_px = 0, height_px = 0;  ///< the view's rectangle in its pass
  std::uint32_t first_row = 0, rows = 0;                          ///< the rows of the image that use this view
  double time_s = 0;  ///< time of the view's pose relative to the frame's time, at most 0
};

/// The position of an image pixel in a view, in pixels from the view's corner.
struct PixelTap {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t view = kNone;  ///< kNone if the pixel sees nothing
  double x_px = 0, y_px = 0;   ///< at least 2.5 pixels from the view's left and top, 3.5 from its right and bottom
};

/// The pixels of the view between which the tap lies, for interpolation.
BeamTap beam_tap(const PixelTap& tap, const Pinhole& pinhole);

struct CameraViews {
  std::vector<CameraView> views;         ///< in the order of their passes
  std::vector<glm::uvec2> pass_size_px;  ///< sizes of the passes that hold the views
  std::vector<PixelTap> taps;            ///< [y * width + x]; empty for a direct image, whose only pass is the image
};

/// `supersampling` is defined in Pass. Views are combined into passes of up to 4096 samples in each direction, unless a
/// single view is larger.
CameraViews camera_views(const CameraLayout& layout, std::uint32_t supersampling);

}  // namespace simvis
