// An image whose pixels are interpolated in rendered views.
//
// Colour   bilinear, in linear light, of the four pixels around; black where the lens sees nothing.
// Depth    of the surface that is met at the pixel itself, along the camera's Z: where the pixels around show one
//          surface that is flat over them, exact as that of a scanner's beam is (see depth_range.h); at a step that of
//          the surface on the pixel's side, never a mean of several. +infinity where nothing is met, or seen. A fisheye
//          looks behind itself, too: there depths are negative.
#pragma once

#include <span>
#include <vector>

#include <simvis/frame_plan.h>
#include <simvis/frame_results.h>
#include <simvis/image.h>
#include "sensors/camera/camera_views.h"
#include "sensors/camera/depth_error_bound.h"

namespace simvis {

/// `passes` and `results` of the views' passes alone, the passes' views in the order of `views`.
void resample_color(const CameraLayout& layout, const CameraViews& views, std::span<const Pass> passes,
                    std::span<const PassResult> results, Image& image);

/// The same for depth; `depth_views` by view. Returns a bound on the error of every depth that is taken from one
/// surface, flat or bent at a crease, in metres; those beside a step have none. 0 where there is none.
double resample_depth(const CameraLayout& layout, const CameraViews& views, std::span<const Pass> passes,
                      std::span<const PassResult> results, std::span<const DepthView> depth_views, Image& image);

}  // namespace simvis
