// Images whose pixels are interpolated from rendered views.
//
// Colour   Bilinear interpolation of the four surrounding pixels in linear light; black where the lens sees nothing.
// Depth    Depth along the camera's Z axis of the surface at the pixel's centre. If the surrounding pixels show one
//          surface that is flat over them, the depth is as exact as the range of a scanner's beam (see depth_range.h).
//          At a step it is the depth of the surface on the pixel's side, never a mean of several surfaces. It is
//          +infinity where nothing is hit or the lens sees nothing. A fisheye also sees directions behind the camera:
//          there depths are negative.
#pragma once

#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/image.h>
#include "sensors/camera/camera_views.h"
#include "sensors/camera/depth_error_bound.h"

namespace simvis {

/// `passes` and `results` hold the passes of `views` only; the views in the passes are in the order of `views`.
void resample_color(const CameraLayout& layout, const CameraViews& views, std::span<const Pass> passes,
                    std::span<const PassResult> results, Image& image);

/// The same for depth; `depth_views` has one entry for each view. Returns a bound in metres on the error of every
/// finite depth: +infinity if one is next to a step, where the pixels do not say which surface its ray hits. 0 if there
/// is no such depth.
double resample_depth(const CameraLayout& layout, const CameraViews& views, std::span<const Pass> passes,
                      std::span<const PassResult> results, std::span<const DepthView> depth_views, Image& image);

}  // namespace simvis
