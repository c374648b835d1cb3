#include "sensors/measured_table.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/glm.hpp>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include "engine/base/assert.h"

namespace simvis {
namespace {

constexpr double kNoPoint = std::numeric_limits<double>::quiet_NaN(),
                 kNoReturn = std::numeric_limits<double>::infinity();

constexpr std::string_view kAzimuth = "azimuth_rad", kElevation = "elevation_rad", kRing = "ring";

/// The number of a beam in an array that may be the same for all rings, or for all beams of a ring.
double number_at(const MeasuredArray& array, std::size_t ring, std::size_t beam) {
  const std::size_t row = array.shape.rows == 1 ? 0 : ring, column = array.shape.columns == 1 ? 0 : beam;
  return array.number(row * array.shape.columns + column);
}

/// Whether number_at() finds a number for each ring and beam of a scan of this shape.
bool has_each_beam(const MeasuredArray& array, const OutputShape& scan) {
  const OutputShape& shape = array.shape;
  return (shape.rows == 1 || shape.rows == scan.rows) && (shape.columns == 1 || shape.columns == scan.columns) &&
         shape.channels == 1;
}

/// Whether an array says something of each beam of a scan.
bool fits_scan(const MeasuredArray& array, const OutputShape& scan) {
  if (array.name == kBeamOrigin) return array.shape == OutputShape{scan.rows, scan.columns, 3};
  if (is_beam_layout(array)) return has_each_beam(array, scan);
  if (array.kind == OutputKind::image) return true;
  return array.kind == OutputKind::scan_column && has_each_beam(array, scan) &&
         array.count() == std::size_t{scan.rows} * scan.columns;
}

TableColumn column_of(const MeasuredArray& array, const Measurement& measurement) {
  const auto bounded = std::ranges::find(measurement.arrays, array.name, &MeasuredArray::bound);
  return {.name = array.name,
          .format = array.format,
          .integer = is_integer(array.value_type),
          .bound_of = bounded == measurement.arrays.end() ? "" : bounded->name,
          .unit = array.unit};
}

/// Fills the rows of a scan.
class ScanRows {
 public:
  explicit ScanRows(const Measurement& scan)
      : scan_(scan),
        range_(require(scan, "range_m")),
        bound_(require(scan, "error_bound_m")),
        azimuth_(require(scan, kAzimuth)),
        elevation_(require(scan, kElevation)),
        azimuth_deg_(scan.find(kAzimuthDeg)),
        elevation_deg_(scan.find(kElevationDeg)),
        ring_(scan.find(kRing)),
        origin_(scan.find(kBeamOrigin)) {
    for (const MeasuredArray& each : scan.arrays) {
      const bool is_channel = each.kind != OutputKind::image && !is_beam_layout(each);
      if (&each != &range_ && &each != &bound_ && is_channel) channels_.push_back(&each);
    }
  }

  MeasuredTable table() const {
    MeasuredTable table{.columns = scan_columns(), .values = {}};
    for (const MeasuredArray* channel : channels_) table.columns.push_back(column_of(*channel, scan_));
    table.values.reserve(range_.count() * table.columns.size());
    for (std::size_t ring = 0; ring < range_.shape.rows; ++ring) {
      for (std::size_t beam = 0; beam < range_.shape.columns; ++beam) add(ring, beam, table.values);
    }
    return table;
  }

 private:
  static const MeasuredArray& require(const Measurement& scan, std::string_view name) {
    const MeasuredArray* const found = scan.find(name);
    SIMVIS_ASSERT(found != nullptr);
    return *found;
  }

  void add(std::size_t ring, std::size_t beam, std::vector<double>& values) const {
    const double a = number_at(azimuth_, ring, beam), e = number_at(elevation_, ring, beam);
    const double range = number_at(range_, ring, beam);
    const double r = std::isfinite(range) ? range : kNoPoint;
    glm::dvec3 point_m(r * std::cos(e) * std::cos(a), r * std::cos(e) * std::sin(a), r * std::sin(e));
    if (origin_ != nullptr) {
      const std::size_t i = 3 * (ring * range_.shape.columns + beam);
      point_m += glm::dvec3(origin_->number(i), origin_->number(i + 1), origin_->number(i + 2));
    }
    values.insert(values.end(), {ring_ == nullptr ? static_cast<double>(ring) : number_at(*ring_, ring, beam),
                                 static_cast<double>(beam),
                                 azimuth_deg_ == nullptr ? glm::degrees(a) : number_at(*azimuth_deg_, ring, beam),
                                 elevation_deg_ == nullptr ? glm::degrees(e) : number_at(*elevation_deg_, ring, beam),
                                 range, number_at(bound_, ring, beam), point_m.x, point_m.y, point_m.z});
    for (const MeasuredArray* channel : channels_) values.push_back(number_at(*channel, ring, beam));
  }

  const Measurement& scan_;
  const MeasuredArray &range_, &bound_, &azimuth_, &elevation_;
  const MeasuredArray *azimuth_deg_, *elevation_deg_, *ring_, *origin_;  // null if the scan does not have them
  std::vector<const MeasuredArray*> channels_;
};

/// The numbers of the array of this name, if it has this type and shape; else null.
template <typename Number>
const SharedArray<Number>* numbers_of(const Measurement& measurement, std::string_view name, const OutputShape& shape) {
  const MeasuredArray* const array = measurement.find(name);
  const auto* const numbers = array == nullptr ? nullptr : std::get_if<SharedArray<Number>>(&array->numbers);
  return numbers != nullptr && array->shape == shape && numbers->size() == array->count() ? numbers : nullptr;
}

/// What every scan has.
struct ScanParts {
  OutputShape shape;
  const SharedArray<float>*range_m, *error_bound_m;
  const SharedArray<double>*azimuth_rad, *elevation_rad;
};

/// Empty: the measurement has no ranges, or its arrays do not fit together.
std::optional<ScanParts> scan_parts(const Measurement& measurement) {
  const MeasuredArray* const range = measurement.find("range_m");
  if (range == nullptr || range->count() == 0 || range->shape.channels != 1) return std::nullopt;
  const OutputShape& shape = range->shape;
  const auto angle = [&](std::string_view name, const OutputShape& grid) {
    const SharedArray<double>* const of_grid = numbers_of<double>(measurement, name, grid);
    return of_grid != nullptr ? of_grid : numbers_of<double>(measurement, name, shape);
  };
  const ScanParts parts{shape, numbers_of<float>(measurement, "range_m", shape),
                        numbers_of<float>(measurement, "error_bound_m", shape), angle(kAzimuth, {1, shape.columns}),
                        angle(kElevation, {shape.rows, 1})};
  const bool has_all = parts.range_m != nullptr && parts.error_bound_m != nullptr && parts.azimuth_rad != nullptr &&
                       parts.elevation_rad != nullptr;
  return has_all ? std::optional(parts) : std::nullopt;
}

}  // namespace

std::vector<std::uint8_t> own_bytes(const MeasuredArray& array) {
  const auto bytes_of = [&]<typename Number>(const SharedArray<Number>& numbers) {
    std::vector<std::uint8_t> bytes(array.count() * sizeof(Number));
    if (array.stride == 1 && !bytes.empty()) {
      std::memcpy(bytes.data(), numbers.data() + array.first, bytes.size());
      return bytes;
    }
    for (std::size_t i = 0; i < array.count(); ++i) {
      std::memcpy(bytes.data() + i * sizeof(Number), &numbers[array.first + i * array.stride], sizeof(Number));
    }
    return bytes;
  };
  return std::visit(bytes_of, array.numbers);
}

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

OutputShape azimuth_shape(const Scan& scan) {
  return {scan.azimuth_rad.size() == scan.beams ? 1 : scan.rings, scan.beams};
}

OutputShape elevation_shape(const Scan& scan) {
  return {scan.rings, scan.elevation_rad.size() == scan.rings ? 1 : scan.beams};
}

Measurement measurement_of(const Scan& scan) {
  Measurement measurement{.time_ns = scan.time_ns, .world_from_sensor = scan.world_from_sensor};
  std::vector<MeasuredArray>& arrays = measurement.arrays;
  arrays.reserve(6 + scan.channels.size());
  const OutputShape shape{scan.rings, scan.beams};
  arrays.push_back(scan_array("range_m", shape, scan.range_m));
  arrays.push_back(scan_array("error_bound_m", shape, scan.error_bound_m));
  arrays.push_back(scan_array("azimuth_rad", azimuth_shape(scan), scan.azimuth_rad));
  arrays.push_back(scan_array("elevation_rad", elevation_shape(scan), scan.elevation_rad));
  if (!scan.ring.empty()) arrays.push_back(scan_array("ring", shape, scan.ring));
  if (!scan.origin_m.empty()) arrays.push_back(scan_array(kBeamOrigin, {scan.rings, scan.beams, 3}, scan.origin_m));
  for (const ScanChannel& channel : scan.channels) {
    arrays.push_back({{.name = channel.name,
                       .kind = OutputKind::scan_column,
                       .shape = channel.values.empty() ? OutputShape{0, 0} : shape,
                       .unit = channel.unit,
                       .format = channel.format},
                      channel.values});
  }
  return measurement;
}

bool is_beam_layout(const MeasuredArray& array) {
  const std::string_view names[] = {kAzimuth, kElevation, kAzimuthDeg, kElevationDeg, kRing, kBeamOrigin};
  return std::ranges::find(names, array.name) != std::end(names);
}

std::optional<Scan> to_scan(const Measurement& measurement) {
  const std::optional<ScanParts> parts = scan_parts(measurement);
  if (!parts) return std::nullopt;
  const OutputShape& shape = parts->shape;
  Scan scan{.rings = shape.rows,
            .beams = shape.columns,
            .azimuth_rad = *parts->azimuth_rad,
            .elevation_rad = *parts->elevation_rad,
            .range_m = *parts->range_m,
            .error_bound_m = *parts->error_bound_m,
            .channels = {},
            .time_ns = measurement.time_ns,
            .world_from_sensor = measurement.world_from_sensor};
  if (const auto* const ring = numbers_of<std::uint32_t>(measurement, kRing, shape)) scan.ring = *ring;
  const OutputShape points{shape.rows, shape.columns, 3};
  if (const auto* const origin = numbers_of<double>(measurement, kBeamOrigin, points)) scan.origin_m = *origin;
  for (const MeasuredArray& each : measurement.arrays) {
    if (is_beam_layout(each)) continue;
    const auto* const values = numbers_of<double>(measurement, each.name, shape);
    if (values != nullptr) scan.channels.push_back({each.name, each.format, *values, each.unit});
  }
  return scan;
}

bool fits_together(const Measurement& measurement) {
  const auto is_of_scan = [](const MeasuredArray& each) { return each.kind == OutputKind::scan_column; };
  if (std::ranges::any_of(measurement.arrays, is_of_scan)) {
    const std::optional<ScanParts> parts = scan_parts(measurement);
    return parts && std::ranges::all_of(measurement.arrays,
                                        [&](const MeasuredArray& each) { return fits_scan(each, parts->shape); });
  }
  std::optional<std::size_t> rows;
  for (const MeasuredArray& each : measurement.arrays) {
    if (each.kind == OutputKind::image) continue;
    if (each.count() != rows.value_or(each.count())) return false;
    rows = each.count();
  }
  return true;
}

MeasuredTable measured_table(const Measurement& measurement) {
  if (measurement.find("range_m") != nullptr && measurement.find("range_m")->kind == OutputKind::scan_column) {
    return ScanRows(measurement).table();
  }
  MeasuredTable table;
  std::vector<const MeasuredArray*> columns;
  for (const MeasuredArray& each : measurement.arrays) {
    if (each.kind == OutputKind::image) continue;
    columns.push_back(&each);
    table.columns.push_back(column_of(each, measurement));
  }
  const std::size_t rows = columns.empty() ? 0 : columns.front()->count();
  table.values.reserve(rows * columns.size());
  for (std::size_t row = 0; row < rows; ++row) {
    for (const MeasuredArray* column : columns) table.values.push_back(column->number(row));
  }
  return table;
}

}  // namespace simvis
