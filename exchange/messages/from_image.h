// Messages from the images of cameras. Their frame is the optical one: x right, y down, z forward (REP 103).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string_view>

#include "exchange/messages/types/sensor_types.h"
#include "scenegraph/image_span.h"

namespace simvis::ros {

/// Colour as 8-bit sRGB: "rgb8", "bgr8"; its linear luminance, 65535 for 1, clamped: "mono16". Depth or another single
/// channel: in metres as it is, "32FC1", and in millimetres, "16UC1", with 0 where there is none or it is beyond 65.535
/// m.
Image to_image(const ImageSpan& image, const Header& header, std::string_view encoding);

/// Counts of 16 bits, rows from the top: "mono16". A count above 65535 is 65535.
Image counts_image(std::span<const std::uint32_t> counts, std::uint32_t width, const Header& header);

/// Colour as a picture: "jpeg" or "png".
CompressedImage compressed_image(const ImageSpan& color, const Header& header, std::string_view format);

/// The format of compressed_depth().
inline constexpr std::string_view kCompressedDepth = "16UC1; compressedDepth png";

/// Depth as image_transport's plug-in compressed_depth_image_transport has it: the millimetres of "16UC1" as a PNG of
/// 16 bits behind 12 bytes for quantisation, which whole millimetres do not use.
CompressedImage compressed_depth(const ImageSpan& depth, const Header& header);

/// Pixel centres are at whole numbers, as ROS counts them. There is no rectification, and P is also that of a distorted
/// image.
CameraInfo camera_info(const CameraCalibration& calibration, const Header& header);

/// The points of a depth image, as optical_points() gives them, in `height` rows. With the colour of the same pixels
/// (null: there is none) the cloud has the field "rgb" in PCL's layout: at 16, the bytes of 0x00RRGGBB (sRGB) as
/// float32. A pixel without a depth is NaN; with `dense` it is left out, and the cloud has one row.
PointCloud2 depth_cloud(std::span<const glm::dvec3> points, std::uint32_t height, const ImageSpan* color,
                        const Header& header, bool dense);

/// `right` is the calibration of the right camera, with its baseline. Exact disparities: delta_d is 0, and 0 pixels is
/// infinitely far, where nothing is hit.
DisparityImage disparity_image(const ImageSpan& disparity, const CameraCalibration& right, const Header& header);

}  // namespace simvis::ros
