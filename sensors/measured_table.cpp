#include "sensors/measured_table.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <utility>

#include "engine/base/assert.h"
#include "scenegraph/scan_arrays.h"

namespace simvis {
namespace {

constexpr double kNoPoint = std::numeric_limits<double>::quiet_NaN();

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
        range_(require(scan, kRange)),
        bound_(require(scan, kRangeBound)),
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

}  // namespace

bool fits_together(const Measurement& measurement) {
  const auto is_of_scan = [](const MeasuredArray& each) { return each.kind == OutputKind::scan_column; };
  if (std::ranges::any_of(measurement.arrays, is_of_scan)) {
    const std::optional<OutputShape> shape = scan_shape(measurement);
    return shape &&
           std::ranges::all_of(measurement.arrays, [&](const MeasuredArray& each) { return fits_scan(each, *shape); });
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
  if (measurement.find(kRange) != nullptr && measurement.find(kRange)->kind == OutputKind::scan_column) {
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
