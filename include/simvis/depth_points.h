// Points of depth images: what the pixels of a camera see, in space.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include <simvis/export.h>
#include <simvis/image.h>
#include <simvis/measurement.h>

namespace simvis {

/// Whether a camera sees straight through its pinhole: its calibration has no distortion.
SIMVIS_API bool is_pinhole(const CameraCalibration& camera);

/// The point at the centre of each pixel of a depth image, through the lens of its camera.
///
/// Frame    optical: x right, y down, z forward.
/// Shape    points[y * width + x], metres; NaN where the pixel has no depth.
/// Empty    the lens is none that SimVis knows, as one of a plug-in may be.
SIMVIS_API std::vector<glm::dvec3> optical_points(const Image& depth, const CameraCalibration& camera);

/// The points of the depth image of a measurement, as optical_points(). `view` is that of the image: "left" or "right"
/// of a stereo camera.
///
/// Frame    the sensor's: x forward, y left, z up, at the place of its measurement (Measurement::world_from_sensor).
/// Empty    there is no depth image of this view, or its lens is not known; no points before the first measurement.
SIMVIS_API std::optional<std::vector<glm::dvec3>> depth_points(const Measurement& measurement,
                                                               std::string_view view = {});

}  // namespace simvis
