#include "program/output/exif.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include <zlib.h>

#include <simvis/image.h>
#include "engine/base/binary_numbers.h"

namespace simvis {
namespace {

constexpr std::string_view kPngStart{"\x89PNG\r\n\x1a\n", 8}, kJpegStart{"\xff\xd8\xff", 3};
constexpr std::size_t kPngHeaderEnd = 33, kJpegStartOfImage = 2;  // behind IHDR, and behind the marker SOI

enum class ExifTag : std::uint16_t {
  exif_directory = 0x8769,
  focal_length = 0x920a,
  focal_plane_x_resolution = 0xa20e,
  focal_plane_y_resolution = 0xa20f,
  focal_plane_resolution_unit = 0xa210
};
enum class ExifType : std::uint16_t { short_number = 3, long_number = 4, rational = 5 };
constexpr std::uint32_t kCentimetre = 3, kDirectoryAt = 8, kExifDirectoryAt = 26, kRationalsAt = 80;

void append_entry(std::string& tiff, ExifTag tag, ExifType type, std::uint32_t value) {
  append_binary(tiff, static_cast<std::uint16_t>(tag));
  append_binary(tiff, static_cast<std::uint16_t>(type));
  append_binary(tiff, std::uint32_t{1});
  append_binary(tiff, value);
}

/// The fraction with the finest decimal denominator that 32 bits hold, up to a millionth.
void append_rational(std::string& tiff, double value) {
  std::uint32_t denominator = 1'000'000;
  while (denominator > 1 && value * denominator > std::numeric_limits<std::uint32_t>::max()) denominator /= 10;
  append_binary(tiff, static_cast<std::uint32_t>(std::llround(value * denominator)));
  append_binary(tiff, denominator);
}

/// A TIFF of two directories: one with the place of the other, which has four entries. The resolution along y is that
/// along x if pixels are square.
std::string exif_of(const CameraCalibration& camera) {
  const double pixels_per_mm = camera.width_px / kNominalWidth_mm;
  const double height_of_pixel = camera.pinhole.fx_px / camera.pinhole.fy_px;
  const bool has_square_pixels = height_of_pixel == 1;
  std::string tiff{"II*\0", 4};
  append_binary(tiff, kDirectoryAt);
  append_binary(tiff, std::uint16_t{1});
  append_entry(tiff, ExifTag::exif_directory, ExifType::long_number, kExifDirectoryAt);
  append_binary(tiff, std::uint32_t{0});
  append_binary(tiff, std::uint16_t{4});
  append_entry(tiff, ExifTag::focal_length, ExifType::rational, kRationalsAt);
  append_entry(tiff, ExifTag::focal_plane_x_resolution, ExifType::rational, kRationalsAt + 8);
  append_entry(tiff, ExifTag::focal_plane_y_resolution, ExifType::rational,
               has_square_pixels ? kRationalsAt + 8 : kRationalsAt + 16);
  append_entry(tiff, ExifTag::focal_plane_resolution_unit, ExifType::short_number, kCentimetre);
  append_binary(tiff, std::uint32_t{0});
  append_rational(tiff, camera.pinhole.fx_px / pixels_per_mm);
  append_rational(tiff, 10 * pixels_per_mm);
  if (!has_square_pixels) append_rational(tiff, 10 * pixels_per_mm / height_of_pixel);
  return tiff;
}

std::string big_endian(std::uint32_t value, int bytes) {
  std::string text;
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 0xff);
  return text;
}

std::string png_chunk(const std::string& content) {
  const std::string body = "eXIf" + content;
  return big_endian(static_cast<std::uint32_t>(content.size()), 4) + body +
         big_endian(static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(body.data()), body.size())),
                    4);
}

std::string jpeg_segment(const std::string& content) {
  const std::string body = std::string("Exif\0\0", 6) + content;
  return "\xff\xe1" + big_endian(static_cast<std::uint32_t>(body.size() + 2), 2) + body;
}

}  // namespace

std::string with_focal_length(std::string picture, const CameraCalibration& camera) {
  if (camera.distortion_model != "plumb_bob" && camera.distortion_model != "rational_polynomial") return picture;
  if (picture.starts_with(kPngStart)) picture.insert(kPngHeaderEnd, png_chunk(exif_of(camera)));
  if (picture.starts_with(kJpegStart)) picture.insert(kJpegStartOfImage, jpeg_segment(exif_of(camera)));
  return picture;
}

}  // namespace simvis
