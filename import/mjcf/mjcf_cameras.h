// Turns the cameras of an MJCF model into sensors.
#pragma once

#include <string>

#include "import/mjcf/mjcf_element.h"
#include "import/model/import_report.h"

namespace simvis {

/// The command of the sensor `camera` at an insertion point, which looks along x. Without a `resolution`
/// its image has 640 x 480 pixels, as that of MuJoCo's renderer. With a `sensorsize` it has the camera's
/// own focal lengths and principal point, otherwise the vertical field of view `fovy`. What a pinhole cannot show is
/// reported. Throws InputError for wrong numbers.
std::string mjcf_camera_command(const MjcfElement& camera, const std::string& name, const std::string& point,
                                ImportReport& report);

}  // namespace simvis
