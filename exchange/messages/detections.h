// Detections of vision_msgs from the boxes that cameras measure as ground truth.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include <simvis/measurement.h>
#include "exchange/messages/types/vision_types.h"

namespace simvis::ros {

struct Detections {
  Detection2DArray in_image;
  Detection3DArray in_space;
};

/// The names of classes by their ids.
using ClassNames = std::map<std::uint32_t, std::string>;

/// Whether these are the arrays of a measurement with the output `boxes` of a camera.
bool has_boxes(std::span<const MeasuredArray> arrays);

/// The objects of which pixels are visible, in the order of the table. `arrays` must have boxes; `view` is the number
/// of the view that is meant (empty: the table has one view).
///
/// Class    its name, or its id if it has none; the score is 1.
/// Id       that of the object in all sensors, frames and runs.
/// 2D       the box of the visible pixels. Pixel centres are at whole numbers, as in CameraInfo.
/// 3D       the box of the object in space, in the optical frame of the view; the pose of the result is its centre.
Detections detections(std::span<const MeasuredArray> arrays, std::optional<std::uint32_t> view,
                      const ClassNames& class_names, const Header& header);

}  // namespace simvis::ros
