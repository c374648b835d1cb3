// The lens of an SDF camera.
#pragma once

#include "import/sdf/sdf_command.h"

namespace simvis {

/// Adds what a <lens> says to the command of a camera: focal lengths and principal point of its <intrinsics>, and the
/// projection of a wide-angle camera. `stereographic` and `orthographic` are double spheres, `equidistant` and
/// `equisolid_angle` are OpenCV's fisheye model, whose four terms are the series of the projection: up to 90 degrees
/// from the axis the radius of `equisolid_angle` is off by at most 10^-5. A projection that is none of these, or that
/// does not fill the picture, is reported as left out. Returns whether the command has a focal length now.
bool add_sdf_lens(const SdfElement& lens, bool is_wide_angle, double width_px, double height_px, double hfov_rad,
                  SdfCommand& command, ImportReport& report);

}  // namespace simvis
