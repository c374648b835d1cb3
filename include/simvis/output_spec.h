// What describes each output of a sensor before anything runs, and each column of a table.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

/// The format of a column whose numbers are printed as the shortest decimals that read back to the same doubles.
inline constexpr std::string_view kExactFormat = "exact";

/// One column of a table that a sensor writes. A value that is NaN is printed as an empty cell.
struct TableColumn {
  std::string name;      ///< heading of the column
  std::string format;    ///< of printf, for one double, or for one long long if `integer`; or kExactFormat
  bool integer = false;  ///< the values are whole numbers
  /// The name of a column to its left. If it is set, the values here bound the errors of the values there, and text is
  /// rounded so that the printed bound also covers the rounding of the printed value.
  std::string bound_of{};
  std::string unit{};               ///< "m", "rad/s"; empty: none, or not said
  std::string meaning{};            ///< a phrase for people, "height above the reference"; empty: not said
  std::string frame{};              ///< the frame that its axes belong to: "sensor", "world"; empty: none
  std::optional<double> nothing{};  ///< the value where nothing was measured; empty: there is always a number
  bool single = false;              ///< each value is a float32
  bool in_message = true;           ///< the message of the sensor's type has the column
};

/// The form of an output.
enum class OutputKind : std::uint8_t {
  image,         ///< numbers per pixel
  scan_column,   ///< one number per beam
  table_column,  ///< one number per row of a table whose number of rows varies
  scalar,        ///< one number per measurement
};

/// What the numbers of an image are, for consumers that have a form of their own for some images.
enum class ImageContent : std::uint8_t {
  numbers,    ///< any; integers are labels
  color,      ///< linear RGB radiance and alpha
  depth,      ///< along the optical axis, in metres
  disparity,  ///< in pixels, positive, of the left image of a rectified pair
  counts,     ///< of a converter of 16 bits: u32, from 0 to 65535
};

/// The type that holds each number of an output without loss.
enum class ValueType : std::uint8_t {
  u8,   ///< a whole number, 8 bits, not negative
  u32,  ///< a whole number, 32 bits, not negative
  i32,  ///< a whole number, 32 bits
  i64,  ///< a whole number; measurements hold it as f64
  f32,  ///< IEEE 754, 32 bits
  f64,  ///< IEEE 754, 64 bits
};

/// Whether it is a type of whole numbers.
constexpr bool is_integer(ValueType type) { return type <= ValueType::i64; }

/// The number of numbers of an output in one measurement. A value is 0 if it differs between measurements.
struct OutputShape {
  std::uint32_t rows = 1,  ///< of an image, rings of a scan, rows of a table
      columns = 1,         ///< of an image, beams in a ring
      channels = 1;        ///< per pixel

  bool operator==(const OutputShape&) const = default;  ///< member by member
};

/// One output of a sensor.
struct OutputSpec {
  /// As in files, arrays and messages. A `*` stands for a name from the scene: the sensor gives one output of this kind
  /// for each thing, such as "*.position_rad" for each joint that turns.
  std::string name;
  OutputKind kind = OutputKind::scalar;          ///< its form
  ValueType value_type = ValueType::f64;         ///< of each number
  OutputShape shape{};                           ///< as far as the command decides it
  ImageContent content = ImageContent::numbers;  ///< of an image
  std::string unit{};                            ///< "m", "rad/s"; empty: none
  std::string frame{};              ///< the frame that its axes belong to: "sensor", "optical"; empty: none
  std::string meaning{};            ///< a phrase for people; empty: the author of the type gives none
  std::optional<double> nothing{};  ///< the value where nothing was measured; empty: none is stated
  std::string bound{};              ///< name of the output that bounds its error; empty: none does
  std::string message{};            ///< the ROS 2 message that has it; empty: none
  std::string when{};               ///< for people: what makes the sensor give it; empty: it always does
  bool given = true;                ///< whether the command makes the sensor give it
  /// It follows from other outputs: tables of points have it, measurements do not.
  bool derived = false;
  /// It takes long to compute, so it is computed when it is read: Simulation::value(), run.json and shared memory have
  /// it.
  bool on_request = false;
  std::string format = "%.9g";  ///< in text, as TableColumn::format
  std::string view{};  ///< of a measured image: the name of its Calibration; "" if the sensor has one view only
};

/// The messages of images and of beams.
inline constexpr std::string_view kImageMessage = "sensor_msgs/msg/Image",
                                  kPointsMessage = "sensor_msgs/msg/PointCloud2";

/// "image", "scan column", "table column", "scalar".
inline std::string_view to_string(OutputKind kind) {
  constexpr std::string_view kNames[] = {"image", "scan column", "table column", "scalar"};
  return kNames[static_cast<std::size_t>(kind)];
}

/// "u8", "u32", "i32", "i64", "f32", "f64".
inline std::string_view to_string(ValueType type) {
  constexpr std::string_view kNames[] = {"u8", "u32", "i32", "i64", "f32", "f64"};
  return kNames[static_cast<std::size_t>(type)];
}

/// "480 x 640 x 4", with n for a number that differs between measurements; "1" for one number.
inline std::string to_string(const OutputShape& shape) {
  if (shape == OutputShape{}) return "1";
  const auto count = [](std::uint32_t number) { return number == 0 ? std::string("n") : std::to_string(number); };
  std::string text = count(shape.rows);
  if (shape.columns != 1 || shape.channels != 1) text += " x " + count(shape.columns);
  if (shape.channels != 1) text += " x " + count(shape.channels);
  return text;
}

/// The type of the numbers of a column.
constexpr ValueType value_type(const TableColumn& column) {
  return column.integer ? ValueType::i64 : column.single ? ValueType::f32 : ValueType::f64;
}

/// One output for each column. Those with a column that bounds them name it.
inline std::vector<OutputSpec> column_outputs(std::span<const TableColumn> columns, OutputKind kind,
                                              const OutputShape& shape = {}) {
  std::vector<OutputSpec> outputs;
  for (const TableColumn& column : columns) {
    const auto bound = std::ranges::find(columns, column.name, &TableColumn::bound_of);
    outputs.push_back({.name = column.name,
                       .kind = kind,
                       .value_type = value_type(column),
                       .shape = shape,
                       .unit = column.unit,
                       .frame = column.frame,
                       .meaning = column.meaning,
                       .nothing = column.nothing,
                       .bound = bound == columns.end() ? "" : bound->name,
                       .format = column.format});
  }
  return outputs;
}

/// Whether one of the outputs is an image of this content.
inline bool has_content(std::span<const OutputSpec> outputs, ImageContent content) {
  return std::ranges::any_of(
      outputs, [&](const OutputSpec& each) { return each.kind == OutputKind::image && each.content == content; });
}

/// The output of this name among those that a command promises; names with `*` stand for many. Null: there is none.
/// The pointer is valid as long as the outputs.
inline const OutputSpec* find_output(std::span<const OutputSpec> outputs, std::string_view name) {
  const auto fits = [&](const OutputSpec& each) {
    const std::string_view known = each.name;
    const std::size_t star = known.find('*');
    if (star == std::string_view::npos) return known == name;
    return name.size() + 1 >= known.size() && name.starts_with(known.substr(0, star)) &&
           name.ends_with(known.substr(star + 1));
  };
  const auto found = std::ranges::find_if(outputs, fits);
  return found == outputs.end() ? nullptr : &*found;
}

}  // namespace simvis
