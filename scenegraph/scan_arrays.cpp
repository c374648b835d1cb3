#include "scenegraph/scan_arrays.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>
#include <variant>

namespace simvis {
namespace {

constexpr double kNoPoint = std::numeric_limits<double>::quiet_NaN(),
                 kNoReturn = std::numeric_limits<double>::infinity();

/// Whether the measurement has the array of this name, with numbers of this type in this shape.
template <typename Number>
bool has(const Measurement& measurement, std::string_view name, const OutputShape& shape) {
  const MeasuredArray* const array = measurement.find(name);
  const auto* const numbers = array == nullptr ? nullptr : std::get_if<SharedArray<Number>>(&array->numbers);
  return numbers != nullptr && array->shape == shape && numbers->size() == array->count();
}

}  // namespace

const std::vector<TableColumn>& scan_columns() {
  static const std::vector<TableColumn> columns{
      {.name = "ring",
       .format = "%lld",
       .integer = true,
       .meaning = "number of the ring, by increasing elevation; of a pattern its channel"},
      {.name = "beam",
       .format = "%lld",
       .integer = true,
       .meaning = "number of the beam in its ring, by increasing azimuth; of a pattern in its order",
       .in_message = false},
      {.name = "azimuth_deg",
       .format = std::string(kExactFormat),
       .unit = "deg",
       .meaning = "of the beam, counter-clockwise from +x about +z",
       .frame = "sensor",
       .in_message = false},
      {.name = "elevation_deg",
       .format = std::string(kExactFormat),
       .unit = "deg",
       .meaning = "of the beam, positive upwards",
       .frame = "sensor",
       .in_message = false},
      {.name = "range_m",
       .format = "%.9g",
       .unit = "m",
       .meaning = "along the beam; 0: nearer than range_min",
       .nothing = kNoReturn,
       .single = true,
       .in_message = false},
      {.name = "error_bound_m",
       .format = "%.9g",
       .bound_of = "range_m",
       .unit = "m",
       .meaning = "largest error of the range; inf: the method cannot decide which surface the beam meets",
       .nothing = kNoReturn,
       .single = true},
      {.name = "x_m", .format = "%.9g", .unit = "m", .meaning = "point, x", .frame = "sensor", .nothing = kNoPoint},
      {.name = "y_m", .format = "%.9g", .unit = "m", .meaning = "point, y", .frame = "sensor", .nothing = kNoPoint},
      {.name = "z_m", .format = "%.9g", .unit = "m", .meaning = "point, z", .frame = "sensor", .nothing = kNoPoint}};
  return columns;
}

std::vector<OutputSpec> scan_outputs(std::uint32_t rings, std::uint32_t beams) {
  const OutputShape shape{rings, beams};
  std::vector<OutputSpec> outputs = column_outputs(scan_columns(), OutputKind::scan_column, shape);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    outputs[i].derived = outputs[i].name != "range_m" && outputs[i].name != "error_bound_m";
    if (scan_columns()[i].in_message) outputs[i].message = kPointsMessage;
    if (outputs[i].name == "range_m") outputs[i].message = rings == 1 ? "sensor_msgs/msg/LaserScan" : kPointsMessage;
  }
  const auto angle = [&](std::string_view name, const OutputShape& angles, const char* meaning) {
    outputs.push_back({.name = std::string(name),
                       .kind = OutputKind::scan_column,
                       .shape = angles,
                       .unit = "rad",
                       .frame = "sensor",
                       .meaning = meaning});
  };
  angle(kAzimuth, {1, beams}, "of the beams of a ring, counter-clockwise from +x about +z");
  angle(kElevation, {rings, 1}, "of the rings, positive upwards");
  outputs.push_back({.name = kBeamOrigin,
                     .kind = OutputKind::scan_column,
                     .shape = {rings, beams, 3},
                     .unit = "m",
                     .frame = "sensor",
                     .meaning = "where the beam starts: x, y, z",
                     .when = "a pattern whose beams do not start at the sensor's origin",
                     .given = false});
  return outputs;
}

MeasuredArray scan_array(std::string_view name, const OutputShape& shape, MeasuredNumbers numbers) {
  static const std::vector<OutputSpec> listed = scan_outputs(0, 0);
  MeasuredArray array{*find_output(listed, name), std::move(numbers)};
  array.value_type = array.held_type();
  array.shape = array.bytes() == 0 ? OutputShape{0, 0} : shape;
  array.derived = false;
  array.given = true;
  return array;
}

std::optional<OutputShape> scan_shape(const Measurement& measurement) {
  const MeasuredArray* const range = measurement.find(kRange);
  if (range == nullptr || range->count() == 0 || range->shape.channels != 1) return std::nullopt;
  const OutputShape& shape = range->shape;
  const auto has_angle = [&](std::string_view name, const OutputShape& grid) {
    return has<double>(measurement, name, grid) || has<double>(measurement, name, shape);
  };
  const bool has_all = has<float>(measurement, kRange, shape) && has<float>(measurement, kRangeBound, shape) &&
                       has_angle(kAzimuth, {1, shape.columns}) && has_angle(kElevation, {shape.rows, 1});
  return has_all ? std::optional(shape) : std::nullopt;
}

bool is_beam_layout(const MeasuredArray& array) {
  const std::string_view names[] = {kAzimuth, kElevation, kAzimuthDeg, kElevationDeg, kRing, kBeamOrigin};
  return std::ranges::find(names, array.name) != std::end(names);
}

}  // namespace simvis
