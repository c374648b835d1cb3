// The focal length of a camera in its pictures, as EXIF.
#pragma once

#include <string>

namespace simvis {

struct CameraCalibration;

/// The picture, a PNG or JPEG, with FocalLength and the resolutions of the focal plane of this camera, from which
/// readers compute the focal lengths in pixels. EXIF counts in millimetres, so the picture counts as kNominalWidth_mm
/// wide. Other bytes, and pictures of a fisheye lens, whose focal length readers would take for that of a pinhole, come
/// back as they are.
std::string with_focal_length(std::string picture, const CameraCalibration& camera);

/// The width of film of 35 mm.
inline constexpr double kNominalWidth_mm = 36;

}  // namespace simvis
