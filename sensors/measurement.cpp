#include <simvis/measurement.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace simvis {
namespace {

MeasuredArray scan_array(std::string name, std::string unit, OutputShape shape, MeasuredNumbers numbers) {
  const bool single = std::holds_alternative<SharedArray<float>>(numbers);
  if (std::visit([](const auto& all) { return all.empty(); }, numbers)) shape = {0, 0};
  return {.name = std::move(name),
          .kind = OutputKind::scan_column,
          .value_type = single ? ValueType::f32 : ValueType::f64,
          .shape = shape,
          .unit = std::move(unit),
          .numbers = std::move(numbers)};
}

}  // namespace

const MeasuredArray* Measurement::find(std::string_view name) const {
  const auto found = std::ranges::find(arrays, name, &MeasuredArray::name);
  return found == arrays.end() ? nullptr : &*found;
}

const CameraCalibration* Measurement::calibration(std::string_view view) const {
  if (calibrations == nullptr) return nullptr;
  const auto found = std::ranges::find(*calibrations, view, &Calibration::view);
  return found == calibrations->end() ? nullptr : &found->camera;
}

std::optional<double> Measurement::value(std::string_view name) const {
  if (const MeasuredArray* const array = find(name); array != nullptr && array->kind == OutputKind::scalar) {
    return array->count() == 0 ? std::numeric_limits<double>::quiet_NaN() : array->number(0);
  }
  const auto found = std::ranges::find(on_request, name, &NumberOnRequest::name);
  if (found == on_request.end()) return std::nullopt;
  return found->compute();
}

MeasuredArray image_array(std::string name, const Image& image, ImageContent content, std::string unit,
                          std::string view) {
  return {.name = std::move(name),
          .kind = OutputKind::image,
          .value_type = ValueType::f32,
          .shape = {image.height, image.width, image.channels},
          .unit = std::move(unit),
          .numbers = image.pixels,
          .content = content,
          .view = std::move(view)};
}

std::optional<Image> to_image(const MeasuredArray& array) {
  const auto* const pixels = std::get_if<SharedArray<float>>(&array.numbers);
  if (array.kind != OutputKind::image || pixels == nullptr) return std::nullopt;
  return Image{array.shape.columns, array.shape.rows, array.shape.channels, *pixels};
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
  arrays.push_back(scan_array("range_m", "m", shape, scan.range_m));
  arrays.push_back(scan_array("error_bound_m", "m", shape, scan.error_bound_m));
  arrays.back().bound_of = "range_m";
  arrays.push_back(scan_array("azimuth_rad", "rad", azimuth_shape(scan), scan.azimuth_rad));
  arrays.push_back(scan_array("elevation_rad", "rad", elevation_shape(scan), scan.elevation_rad));
  if (!scan.ring.empty()) {
    arrays.push_back(scan_array("ring", "", shape, scan.ring));
    arrays.back().value_type = ValueType::u32;
    arrays.back().format = "%lld";
  }
  if (!scan.origin_m.empty()) {
    arrays.push_back(scan_array(kBeamOrigin, "m", {scan.rings, scan.beams, 3}, scan.origin_m));
  }
  for (const ScanChannel& channel : scan.channels) {
    arrays.push_back(scan_array(channel.name, channel.unit, shape, channel.values));
    arrays.back().format = channel.format;
  }
  return measurement;
}

Measurement measurement_of(const Reading& reading) {
  Measurement measurement{
      .time_ns = reading.time_ns, .world_from_sensor = reading.world_from_sensor, .constants = reading.constants};
  measurement.arrays.reserve(reading.columns.size());
  const auto rows = static_cast<std::uint32_t>(reading.rows());
  for (const TableColumn& column : reading.columns) {
    measurement.arrays.push_back({.name = column.name,
                                  .kind = reading.one_row ? OutputKind::scalar : OutputKind::table_column,
                                  .value_type = value_type(column),
                                  .shape = {rows, 1, 1},
                                  .unit = column.unit,
                                  .numbers = reading.values,
                                  .first = measurement.arrays.size(),
                                  .stride = reading.columns.size(),
                                  .format = column.format,
                                  .bound_of = column.bound_of});
  }
  return measurement;
}

}  // namespace simvis
