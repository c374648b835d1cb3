// Labels of objects in a picture, as the object benchmark of KITTI has them: the files of label_2.
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "program/datasets/seen_view.h"

namespace simvis {

/// Returns a line for each object of the view that shows a pixel: type, truncated, occluded, alpha, the box in pixels
/// (left, top, right, bottom), height, width, length, x, y, z of the middle of its lower side and rotation_y in the
/// view's optical frame. Metres and radians.
///
/// Type      the name of the class, with '_' in place of blanks; `class_ID` for a class without a name.
/// Box       of the whole silhouette, hidden pixels too, within the picture; numbers of its first and last pixels.
/// Occluded  0, 1, 2 (not, partly, largely): at least 0.8, at least 0.4, less of the silhouette is visible.
/// Rotation  about the y axis alone: of an object that leans, the direction of its x axis, seen from above.
std::string kitti_labels(const SeenView& view, const std::map<std::uint32_t, std::string>& classes);

}  // namespace simvis
