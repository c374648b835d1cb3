// NumPy's formats: one array per .npy file, several in an .npz file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <simvis/image.h>
#include <simvis/measurement.h>
#include "program/output/table_frame.h"
#include "scenegraph/image_span.h"

namespace simvis {

/// A structured array with one record per row and one field per column, of the types of number_type().
std::string encode_npy(const TableFrame& table);

/// An image of one channel: float32, shape (height, width), rows from the top.
std::string encode_npy(const Image& plane);
/// Linear colour as the sRGB codes of a PNG: uint8, shape (height, width, 3), rows from the top.
std::string encode_color_npy(const ImageSpan& color);
/// An image of any type, rows from the top: shape (height, width), or (height, width, channels) if there are several.
std::string encode_npy(const MeasuredArray& image);

/// An array of any shape in the order of C, whose numbers are as many as the product of `shape` (asserted).
std::string encode_npy(std::span<const std::int8_t> numbers, std::span<const std::size_t> shape);
std::string encode_npy(std::span<const double> numbers, std::span<const std::size_t> shape);

/// One array per column, of float64 or int64, and `frame`, `time_s` and `world_from_sensor` (4 x 4, the translation in
/// the last column) as further arrays. Compressed.
std::string encode_npz(const TableFrame& table);

}  // namespace simvis
