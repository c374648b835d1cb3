// What a camera renders for its image: pinhole views, and how the pixels of the image are taken from them. Pure
// geometry, made once, in double.
//
// Direct     An image without rays of its own is what a pinhole sees: one view of it, or, with a row time, one for each
//            group of rows that share a pose. The views' pixels are the image's.
// Resampled  An image with rays is covered, for each group of rows, by one view along the optical axis as long as that
//            takes at most kMaxSpread times the image's pixels; otherwise by up to six views along the axes of a cube,
//            each of which takes the rays that are nearest to its axis. All have `oversampling` times the image's focal
//            length and are cut down to the pixels that are looked at and their neighbourhood, neighbours beyond
//            another view's border included. So what a pixel shows is interpolated in one view, of pixels that show the
//            same wherever the border is, and there is no seam.
//            Each pixel is interpolated at one point: an image that is much coarser than its views aliases, as one does
//            that is rendered directly.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include <simvis/camera_effect.h>
#include <simvis/frame_plan.h>
#include "sensors/laser_scanner/scan_layout.h"

namespace simvis {

/// How many times the image's pixels one view may have, so that it is taken instead of a cube's.
inline constexpr double kMaxSpread = 4;

/// One rendered view.
///
/// Frames   F = its own, V = the camera's, both x right, y down, z forward.
struct CameraView {
  glm::dmat3 face_from_view{1.0};  ///< F from V
  Pinhole pinhole;
  std::size_t pass = 0;
  std::uint32_t x_px = 0, y_px = 0, width_px = 0, height_px = 0;  ///< in its pass
  std::uint32_t first_row = 0, rows = 0;                          ///< of the image, that it is seen for
  double time_s = 0;                                              ///< of its pose, from the frame's: 0 or before
};

/// Where a pixel of the image lies in a view, in pixels from the view's corner.
struct PixelTap {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  std::uint32_t view = kNone;  ///< kNone: it sees nothing
  double x_px = 0, y_px = 0;   ///< 2.5 pixels or more from the view's left and top, 3.5 from its right and bottom
};

/// Between which pixels of the view it lies, for interpolation.
BeamTap beam_tap(const PixelTap& tap, const Pinhole& pinhole);

struct CameraViews {
  std::vector<CameraView> views;         ///< by pass
  std::vector<glm::uvec2> pass_size_px;  ///< of the passes that they lie in
  std::vector<PixelTap> taps;            ///< [y * width + x]; empty: direct, the only pass is the image
};

/// `grid` as in Pass: views are put together into passes of up to 4096 samples each way, unless one alone is larger.
CameraViews camera_views(const CameraLayout& layout, std::uint32_t supersampling);

}  // namespace simvis
