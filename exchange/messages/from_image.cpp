#include "exchange/messages/from_image.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "engine/base/assert.h"
#include "exchange/messages/cloud.h"
#include "scenegraph/pictures/png_bytes.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis::ros {

namespace {

constexpr double kMillimetres = 1000;  // per metre
constexpr double kMaxCode = 65535;

std::vector<std::uint8_t> rgb8(const ImageSpan& image) { return srgb_codes(image); }

std::vector<std::uint8_t> bgr8(const ImageSpan& image) {
  std::vector<std::uint8_t> codes = srgb_codes(image);
  for (std::size_t i = 0; i < codes.size(); i += 3) std::swap(codes[i], codes[i + 2]);
  return codes;
}

std::vector<std::uint8_t> float32(const ImageSpan& image) {
  std::vector<std::uint8_t> bytes(image.pixels.size() * sizeof(float));
  std::memcpy(bytes.data(), image.pixels.data(), bytes.size());
  return bytes;
}

void append_code(std::vector<std::uint8_t>& bytes, std::uint16_t code) {
  bytes.push_back(static_cast<std::uint8_t>(code & 0xff));
  bytes.push_back(static_cast<std::uint8_t>(code >> 8));
}

template <typename CodeOf>
std::vector<std::uint8_t> uint16(const ImageSpan& image, const CodeOf& code_of) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(image.pixels.size() / image.channels * sizeof(std::uint16_t));
  for (std::size_t i = 0; i < image.pixels.size(); i += image.channels) append_code(bytes, code_of(&image.pixels[i]));
  return bytes;
}

// The luminance of linear colour with the primaries of sRGB.
std::uint16_t luminance_code(const float* rgb) {
  const double luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
  return luminance > 0 ? static_cast<std::uint16_t>(std::lround(std::min(luminance, 1.0) * kMaxCode)) : 0;
}

std::uint16_t millimetre_code(const float* depth_m) {
  const double code = std::round(static_cast<double>(*depth_m) * kMillimetres);
  return code >= 0 && code <= kMaxCode ? static_cast<std::uint16_t>(code) : 0;
}

struct EncodingRow {
  std::string_view name;
  std::uint32_t channels;  // of the image that it is made from
  std::uint32_t pixel_bytes;
  std::vector<std::uint8_t> (*encode)(const ImageSpan&);
};

constexpr EncodingRow kEncodings[] = {
    {"rgb8", 4, 3, rgb8},
    {"bgr8", 4, 3, bgr8},
    {"mono16", 4, 2, [](const ImageSpan& image) { return uint16(image, luminance_code); }},
    {"32FC1", 1, 4, float32},
    {"16UC1", 1, 2, [](const ImageSpan& image) { return uint16(image, millimetre_code); }}};

}  // namespace

Image to_image(const ImageSpan& image, const Header& header, std::string_view encoding) {
  const auto* const row = std::ranges::find(kEncodings, encoding, &EncodingRow::name);
  SIMVIS_ASSERT(row != std::end(kEncodings) && row->channels == image.channels);
  Image message;
  message.header = header;
  message.height = image.height;
  message.width = image.width;
  message.encoding = encoding;
  message.step = image.width * row->pixel_bytes;
  message.data = row->encode(image);
  return message;
}

Image counts_image(std::span<const std::uint32_t> counts, std::uint32_t width, const Header& header) {
  SIMVIS_ASSERT(width > 0 && counts.size() % width == 0);
  Image message;
  message.header = header;
  message.height = static_cast<std::uint32_t>(counts.size() / width);
  message.width = width;
  message.encoding = "mono16";
  message.step = width * static_cast<std::uint32_t>(sizeof(std::uint16_t));
  message.data.reserve(counts.size() * sizeof(std::uint16_t));
  for (const std::uint32_t count : counts) {
    append_code(message.data, static_cast<std::uint16_t>(std::min(count, std::uint32_t{0xffff})));
  }
  return message;
}

CompressedImage compressed_image(const ImageSpan& color, const Header& header, std::string_view format) {
  SIMVIS_ASSERT(format == "jpeg" || format == "png");
  const std::string bytes = format == "png" ? encode_png(color) : encode_jpeg(color);
  return {header, std::string(format), {bytes.begin(), bytes.end()}};
}

CompressedImage compressed_depth(const ImageSpan& depth, const Header& header) {
  constexpr std::size_t kQuantisationBytes = 12;
  std::vector<std::uint8_t> codes = uint16(depth, millimetre_code);
  for (std::size_t i = 0; i + 1 < codes.size(); i += 2) std::swap(codes[i], codes[i + 1]);  // PNG: high byte first
  const std::string png = png_bytes(
      {.width = depth.width, .height = depth.height, .bits = 16, .channels = 1, .filter = PngFilter::up}, codes);
  CompressedImage message{header, std::string(kCompressedDepth), std::vector<std::uint8_t>(kQuantisationBytes)};
  message.data.insert(message.data.end(), png.begin(), png.end());
  return message;
}

CameraInfo camera_info(const CameraCalibration& calibration, const Header& header) {
  const double fx = calibration.pinhole.fx_px, fy = calibration.pinhole.fy_px;
  const double cx = calibration.pinhole.cx_px - 0.5, cy = calibration.pinhole.cy_px - 0.5;
  CameraInfo message;
  message.header = header;
  message.height = calibration.height_px;
  message.width = calibration.width_px;
  message.distortion_model = calibration.distortion_model;
  message.d = calibration.distortion_coefficients;
  message.k = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
  message.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double tx = calibration.baseline_m == 0 ? 0.0 : -fx * calibration.baseline_m;
  message.p = {fx, 0, cx, tx, 0, fy, cy, 0, 0, 0, 1, 0};
  return message;
}

PointCloud2 depth_cloud(std::span<const glm::dvec3> points, std::uint32_t height, const ImageSpan* color,
                        const Header& header, bool dense) {
  // The sizes of PCL's PointXYZRGB and PointXYZ.
  constexpr std::uint32_t kColorAt = 16, kColoredStep = 32, kStep = 16;
  constexpr CloudField kColorField[] = {{"rgb", kFloat32, kColorAt}};
  if (color == nullptr) {
    PointCloud2 cloud = empty_cloud(header, {}, kStep);
    fill_cloud(cloud, points, height, dense, [](std::size_t, std::uint8_t*) {});
    return cloud;
  }
  SIMVIS_ASSERT(std::size_t{color->width} * color->height == points.size());
  const std::vector<std::uint8_t> codes = srgb_codes(*color);
  PointCloud2 cloud = empty_cloud(header, kColorField, kColoredStep);
  fill_cloud(cloud, points, height, dense, [&](std::size_t i, std::uint8_t* point) {
    put(point, kColorAt, std::uint32_t{codes[3 * i]} << 16 | std::uint32_t{codes[3 * i + 1]} << 8 | codes[3 * i + 2]);
  });
  return cloud;
}

DisparityImage disparity_image(const ImageSpan& disparity, const CameraCalibration& right, const Header& header) {
  DisparityImage message;
  message.header = header;
  message.image = to_image(disparity, header, "32FC1");
  message.f = static_cast<float>(right.pinhole.fx_px);
  message.t = static_cast<float>(right.baseline_m);
  message.valid_window.height = disparity.height;
  message.valid_window.width = disparity.width;
  message.max_disparity = disparity.pixels.empty() ? 0 : *std::ranges::max_element(disparity.pixels);
  return message;
}

}  // namespace simvis::ros
