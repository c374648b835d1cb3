#include "program/output/npy_file.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>
#include <variant>

#include "engine/base/assert.h"
#include "engine/base/binary_numbers.h"
#include "program/output/formats.h"
#include "program/output/zip_file.h"
#include "scenegraph/pictures/png_file.h"

namespace simvis {

namespace {

/// Version 1.0 of the format: the header is padded so that the data begins at a multiple of 64 bytes.
std::string npy_header(const std::string& type, const std::string& shape) {
  constexpr std::size_t kPrefixBytes = 10, kAlignment = 64;
  std::string header = "{'descr': " + type + ", 'fortran_order': False, 'shape': " + shape + ", }";
  header.append(kAlignment - 1 - (kPrefixBytes + header.size()) % kAlignment, ' ');
  header += '\n';
  SIMVIS_ASSERT(header.size() <= 0xffff);
  std::string bytes = "\x93NUMPY";
  bytes += {'\x01', '\x00', static_cast<char>(header.size() & 0xff), static_cast<char>(header.size() >> 8)};
  return bytes + header;
}

std::string shape_of(std::size_t length) { return "(" + std::to_string(length) + ",)"; }

/// A tuple of Python.
std::string shape_of(std::span<const std::size_t> lengths, std::size_t count) {
  std::size_t product = 1;
  std::string text = "(";
  for (const std::size_t length : lengths) {
    product *= length;
    text += std::to_string(length) + ", ";
  }
  SIMVIS_ASSERT(product == count);
  if (!lengths.empty()) text.resize(text.size() - (lengths.size() > 1 ? 2 : 1));
  return text + ")";
}

const char* type_name(NumberType type) {
  switch (type) {
    case NumberType::int32:
      return "'<i4'";
    case NumberType::int64:
      return "'<i8'";
    case NumberType::float32:
      return "'<f4'";
    case NumberType::float64:
      break;
  }
  return "'<f8'";
}

template <typename Number>
const char* type_name() {
  if constexpr (std::is_same_v<Number, float>) return "'<f4'";
  if constexpr (std::is_same_v<Number, std::uint8_t>) return "'|u1'";
  if constexpr (std::is_same_v<Number, std::uint32_t>) return "'<u4'";
  if constexpr (std::is_same_v<Number, std::int32_t>) return "'<i4'";
  return "'<f8'";
}

/// Names may hold any characters.
std::string python_text(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "'";
}

template <typename Number>
std::string array_of(const char* type, const std::string& shape, std::span<const Number> values) {
  std::string bytes = npy_header(type, shape);
  append_binary_all(bytes, values);
  return bytes;
}

std::string column_array(const TableFrame& table, std::size_t column) {
  std::vector<double> values;
  std::vector<std::int64_t> whole;
  for (std::size_t row = 0; row < table.rows(); ++row) values.push_back(table.at(row, column));
  if (!table.columns[column].integer) return array_of<double>("'<f8'", shape_of(values.size()), values);
  whole.reserve(values.size());
  for (const double value : values) whole.push_back(std::isnan(value) ? -1 : static_cast<std::int64_t>(value));
  return array_of<std::int64_t>("'<i8'", shape_of(whole.size()), whole);
}

}  // namespace

std::string encode_npy(const TableFrame& table) {
  std::string fields;
  std::vector<NumberType> types;
  for (const TableColumn& column : table.columns) {
    types.push_back(number_type(column));
    fields += "(" + python_text(column.name) + ", " + type_name(types.back()) + "), ";
  }
  std::string bytes = npy_header("[" + fields + "]", shape_of(table.rows()));
  for (std::size_t row = 0; row < table.rows(); ++row) {
    for (std::size_t c = 0; c < types.size(); ++c) append_as(bytes, types[c], table.at(row, c));
  }
  return bytes;
}

std::string encode_npy(const Image& plane) {
  SIMVIS_ASSERT(plane.channels == 1);
  return array_of<float>("'<f4'", "(" + std::to_string(plane.height) + ", " + std::to_string(plane.width) + ")",
                         plane.pixels);
}

std::string encode_color_npy(const ImageSpan& color) {
  const std::string shape = "(" + std::to_string(color.height) + ", " + std::to_string(color.width) + ", 3)";
  return array_of<std::uint8_t>(type_name<std::uint8_t>(), shape, srgb_codes(color));
}

std::string encode_npy(const MeasuredArray& image) {
  std::string shape = "(" + std::to_string(image.shape.rows) + ", " + std::to_string(image.shape.columns);
  if (image.shape.channels > 1) shape += ", " + std::to_string(image.shape.channels);
  return std::visit(
      [&]<typename Number>(const SharedArray<Number>& numbers) {
        return array_of<Number>(type_name<Number>(), shape + ")", numbers.numbers());
      },
      image.numbers);
}

std::string encode_npy(std::span<const std::int8_t> numbers, std::span<const std::size_t> shape) {
  return array_of<std::int8_t>("'|i1'", shape_of(shape, numbers.size()), numbers);
}

std::string encode_npy(std::span<const double> numbers, std::span<const std::size_t> shape) {
  return array_of<double>("'<f8'", shape_of(shape, numbers.size()), numbers);
}

std::string encode_npz(const TableFrame& table) {
  std::vector<ZipEntry> entries;
  const std::int64_t frame[] = {static_cast<std::int64_t>(table.time.index)};
  const double time_s[] = {static_cast<double>(table.time.time_ns) / 1e9};
  std::vector<double> pose;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) pose.push_back(table.world_from_sensor[column][row]);
  }
  const auto add = [&](const std::string& name, std::string array) {
    entries.push_back({name + ".npy", std::move(array)});
  };
  add("frame", array_of<std::int64_t>("'<i8'", "()", frame));
  // A table with times of its own has a column of this name.
  if (!table.find("time_s")) add("time_s", array_of<double>("'<f8'", "()", time_s));
  add("world_from_sensor", array_of<double>("'<f8'", "(4, 4)", pose));
  for (std::size_t c = 0; c < table.columns.size(); ++c) add(table.columns[c].name, column_array(table, c));
  return encode_zip(entries);
}

namespace {

const FormatRegistration kColorNpyFormat(
    {.kind = "color",
     .name = "rgb8",
     .file = "CAMERA/000000.npy",
     .text =
         "a NumPy array of uint8, height x width x 3: the pixels of the PNG without its compression, which is fast to "
         "write",
     .order = 40,
     .encode_color = encode_color_npy}),
    kDepthNpyFormat({.kind = "depth",
                     .name = "npy",
                     .file = "CAMERA_depth/000000.npy",
                     .text = "a NumPy array of float32, metres",
                     .order = 20,
                     .encode_depth = [](const Image&depth, double) { return encode_npy(depth); }}),
    kTableNpyFormat(
        {.kind = "scan",
         .name = "npy",
         .file = "SCANNER/000000.npy",
         .text =
             "the same columns for one frame, without `frame` and `time_s`: a structured NumPy array with float32 for "
             "what the CSV prints with nine digits, float64 for angles, and int64 for whole numbers",
         .order = 10,
         .encode_table = encode_npy}),
    kTableNpzFormat({.kind = "scan",
                     .name = "npz",
                     .file = "SCANNER/000000.npz",
                     .text = "one NumPy array for each column, with `frame`, `time_s` and `world_from_sensor` (4 x 4)",
                     .order = 20,
                     .encode_table = encode_npz});

}  // namespace

}  // namespace simvis
