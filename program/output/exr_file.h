// Encodes colour and depth in full precision as OpenEXR images.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include <simvis/camera_layout.h>
#include <simvis/frame_time.h>
#include <simvis/image.h>
#include <simvis/measurement.h>

namespace simvis {

/// When and where an image was taken. The header of an EXR file has it as attributes: `frame` (int), `time_s` (double),
/// `world_from_sensor` (m44d) and, if they are known, `camera_matrix` (m33d). The rows of a matrix stand one after the
/// other, as on paper: the translation is the last column of the first, and the principal point that of the second.
struct ImageOrigin {
  FrameTime time;
  glm::dmat4 world_from_sensor{1.0};
  /// Pixel centres are at whole numbers in the file, as in the camera's yaml file; here they are at halves.
  std::optional<Pinhole> pinhole{};
};

/// Returns the bytes of a ZIP-compressed scanline EXR file with float32 channels, in which blocks of rows that hardly
/// get smaller stay uncompressed, as the format allows: linear R, G and B if `color` is
/// given, Z (depth along Z in metres) if `depth` is given. At least one is not null; both have the same size. Throws
/// MachineError with the reason from OpenEXR.
std::string encode_exr(const Image* color, const Image* depth, const ImageOrigin& origin);

/// Whether the format has the type of the numbers: float32, uint32, or uint8, which is stored as uint32.
bool fits_exr(const MeasuredArray& image);

/// As encode_exr(), of any image that fits_exr(). A single channel has the name of the output; of two to four channels
/// NAME.X, NAME.Y, NAME.Z and NAME.W; of more NAME.0, NAME.1 and so on.
std::string encode_exr(const MeasuredArray& image, const ImageOrigin& origin);

}  // namespace simvis
