// The focal length in PNG and JPEG as EXIF, read by the definitions of these formats and of TIFF.
#include "program/output/exif.h"

#include <doctest/doctest.h>
#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <simvis/image.h>
#include "engine/base/binary_numbers.h"
#include "scenegraph/pictures/png_file.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr std::uint16_t kExifDirectory = 0x8769, kFocalLength = 0x920a, kXResolution = 0xa20e, kYResolution = 0xa20f,
                        kResolutionUnit = 0xa210;
constexpr std::uint32_t kCentimetre = 3;
constexpr double kMillimetresPerCentimetre = 10;

std::uint32_t big_endian_at(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes.at(at + i));
  return value;
}

CameraCalibration camera_with(double fx_px, std::uint32_t width_px, std::string distortion_model = "plumb_bob") {
  CameraCalibration camera;
  camera.width_px = width_px;
  camera.height_px = 48;
  camera.pinhole = {fx_px, fx_px, width_px / 2.0, 24};
  camera.distortion_model = std::move(distortion_model);
  return camera;
}

std::string small_png() { return encode_png(Image{2, 1, 4, std::vector<float>{0, 0.2f, 1, 1, 1, 0.5f, 0, 1}}); }

// SOI, a comment and EOI.
std::string small_jpeg() { return std::string("\xff\xd8\xff\xfe\0\5abc\xff\xd9", 11); }

/// The part of the picture that holds EXIF: where it begins, its bytes, and the TIFF in it.
struct ExifPart {
  std::size_t at, bytes;
  std::string tiff;
};

ExifPart png_part(const std::string& png) {
  constexpr std::size_t kAt = 8 + 4 + 4 + 13 + 4;  // the signature, and IHDR with length, type and CRC
  const std::uint32_t length = big_endian_at(png, kAt, 4);
  REQUIRE(png.substr(kAt + 4, 4) == "eXIf");
  const std::string checked = png.substr(kAt + 4, 4 + length);
  CHECK(big_endian_at(png, kAt + 8 + length, 4) ==
        crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size())));
  return {kAt, 12 + length, checked.substr(4)};
}

ExifPart jpeg_part(const std::string& jpeg) {
  constexpr std::size_t kAt = 2;  // behind SOI
  REQUIRE(big_endian_at(jpeg, kAt, 2) == 0xffe1);
  const std::uint32_t length = big_endian_at(jpeg, kAt + 2, 2);  // counts itself
  REQUIRE(jpeg.substr(kAt + 4, 6) == std::string("Exif\0\0", 6));
  return {kAt, 2 + length, jpeg.substr(kAt + 10, length - 8)};
}

struct Rational {
  std::uint32_t numerator, denominator;
  double value() const { return static_cast<double>(numerator) / denominator; }
  /// The numerator is rounded; 1 % more than half a code, because the value is itself rounded.
  double tolerance_rel() const { return 1.01 * 0.5 / numerator; }
};

/// The values of a directory of a little-endian TIFF, as they stand in the entries.
std::map<std::uint16_t, std::uint32_t> directory_at(const std::string& tiff, std::uint32_t at) {
  std::map<std::uint16_t, std::uint32_t> values;
  const auto count = binary_at<std::uint16_t>(tiff, at);
  for (std::size_t entry = at + 2; entry < at + 2 + 12u * count; entry += 12) {
    CHECK(binary_at<std::uint32_t>(tiff, entry + 4) == 1);  // one number
    values[binary_at<std::uint16_t>(tiff, entry)] = binary_at<std::uint32_t>(tiff, entry + 8);
  }
  CHECK(binary_at<std::uint32_t>(tiff, at + 2 + 12u * count) == 0);  // no directory follows
  return values;
}

/// What readers compute.
struct ReadExif {
  Rational focal_length_mm, pixels_per_cm, rows_per_cm;
  double fy_px() const { return focal_length_mm.value() * rows_per_cm.value() / kMillimetresPerCentimetre; }
  double fx_px() const { return focal_length_mm.value() * pixels_per_cm.value() / kMillimetresPerCentimetre; }
};

ReadExif exif_in(const std::string& tiff) {
  REQUIRE(tiff.substr(0, 4) == std::string("II*\0", 4));
  const auto first = directory_at(tiff, binary_at<std::uint32_t>(tiff, 4));
  const auto exif = directory_at(tiff, first.at(kExifDirectory));
  const auto rational = [&](std::uint16_t tag) { return binary_at<Rational>(tiff, exif.at(tag)); };
  CHECK(exif.at(kResolutionUnit) == kCentimetre);
  return {rational(kFocalLength), rational(kXResolution), rational(kYResolution)};
}

void check_focal_length(const ReadExif& read, const CameraCalibration& camera) {
  const double width_px = read.pixels_per_cm.value() * kNominalWidth_mm / kMillimetresPerCentimetre;
  CHECK(std::abs(width_px / camera.width_px - 1) <= read.pixels_per_cm.tolerance_rel());
  CHECK(std::abs(read.fx_px() / camera.pinhole.fx_px - 1) <=
        read.focal_length_mm.tolerance_rel() + read.pixels_per_cm.tolerance_rel());
  CHECK(std::abs(read.fy_px() / camera.pinhole.fy_px - 1) <=
        read.focal_length_mm.tolerance_rel() + read.rows_per_cm.tolerance_rel());
}

}  // namespace

TEST_CASE("EXIF of PNG and JPEG: readers get the focal length of every camera, and all other bytes are as before") {
  for (const double fx_px : {0.05, 20.0, 457.0, 12345.678}) {
    for (const std::uint32_t width_px : {1u, 64u, 640u, 16384u}) {
      CAPTURE(fx_px);
      CAPTURE(width_px);
      for (const bool is_png : {true, false}) {
        CAPTURE(is_png);
        CameraCalibration camera = camera_with(fx_px, width_px, is_png ? "plumb_bob" : "rational_polynomial");
        if (width_px == 640) camera.pinhole.fy_px = (is_png ? 0.75 : 1.3) * fx_px;
        const std::string before = is_png ? small_png() : small_jpeg(), after = with_focal_length(before, camera);
        const ExifPart part = is_png ? png_part(after) : jpeg_part(after);
        check_focal_length(exif_in(part.tiff), camera);
        CHECK(std::string(after).erase(part.at, part.bytes) == before);
      }
    }
  }
}

TEST_CASE("EXIF: a focal length that a millionth has no place for gets the finest denominator that 32 bits hold") {
  // In a picture of 36 pixels, pixels are millimetres. 2^32 - 1 is 4,294,967,295.
  struct Case {
    double fx_px;
    std::uint32_t denominator;
  };
  for (const Case& each : {Case{4294, 1'000'000}, {4295, 100'000}, {42949, 100'000}, {42950, 10'000}, {4.2e9, 1}}) {
    CAPTURE(each.fx_px);
    const CameraCalibration camera = camera_with(each.fx_px, 36);
    const ReadExif read = exif_in(png_part(with_focal_length(small_png(), camera)).tiff);
    CHECK(read.focal_length_mm.denominator == each.denominator);
    check_focal_length(read, camera);
  }
}

TEST_CASE("EXIF: pictures of a fisheye lens, and files that are neither PNG nor JPEG, are as before") {
  CHECK(with_focal_length(small_png(), camera_with(20, 64, "equidistant")) == small_png());
  CHECK(with_focal_length(small_jpeg(), camera_with(20, 64, "equidistant")) == small_jpeg());
  for (const std::string other : {"", "\x89PNG", "\xff\xd8", "P6 1 1 255 abc"}) {
    CHECK(with_focal_length(other, camera_with(20, 64)) == other);
  }
}

}  // namespace simvis

TEST_SUITE_END();
