// The lens of an SDF camera.
#pragma once

#include "import/sdf/sdf_command.h"

namespace simvis {

/// Adds what a <lens> says to the command of a camera: focal lengths and principal point of its <intrinsics>, and the
/// projection of a wide-angle camera as OpenCV's fisheye model, whose four terms are the series of the projection. They
/// are exact for `equidistant`; up to 90 degrees from the axis the radius is off by at most 0.1 % for `stereographic`
/// and 10^-5 for `equisolid_angle` and `orthographic`. A projection that the series cannot show, or that does not fill
/// the picture, is reported as left out.
void add_sdf_lens(const SdfElement& lens, bool is_wide_angle, double width_px, double height_px, double hfov_rad,
                  SdfCommand& command, ImportReport& report);

}  // namespace simvis
