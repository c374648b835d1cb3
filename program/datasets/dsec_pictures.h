// Pictures of DSEC with numbers of 16 bits.
#pragma once

#include <string>

#include <simvis/image.h>
#include <simvis/measurement.h>

namespace simvis {

/// Flow of two channels in pixels, x right, y down, as RGB: 128 steps a pixel from 2^15 on in red and green; blue is 1
/// where the flow is a number that these steps reach, and all are 0 elsewhere.
std::string flow_png(const MeasuredArray& flow);

/// The disparity, in 1/256 of a pixel, of `depth` in a rectified pair with this focal length times the distance of its
/// cameras: 0 where nothing is seen, or where the number is not below 2^16.
std::string disparity_png(const Image& depth, double focal_px_baseline_m);

}  // namespace simvis
