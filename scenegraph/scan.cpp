#include <simvis/scan.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <variant>

#include <simvis/size_product.h>
#include "engine/base/assert.h"
#include "scenegraph/scan_arrays.h"

namespace simvis {
namespace {

/// The numbers of an array; none if there is no such array, or if it holds another type.
template <typename Number>
SharedNumbers<Number> numbers_of(const MeasuredArray* array) {
  const auto* const numbers = array == nullptr ? nullptr : std::get_if<SharedArray<Number>>(&array->numbers);
  if (numbers == nullptr) return {};
  return *numbers;
}

/// As above; none if the array has another shape, as one from elsewhere may have.
template <typename Number>
SharedNumbers<Number> numbers_of(const MeasuredArray* array, const OutputShape& shape) {
  return numbers_of<Number>(array != nullptr && array->shape == shape ? array : nullptr);
}

}  // namespace

Scan::Scan(std::uint32_t rings_of_scan, std::uint32_t beams_of_ring) : rings(rings_of_scan), beams(beams_of_ring) {
  put(kRange, {}, SharedArray<float>());
  put(kRangeBound, {}, SharedArray<float>());
}

Scan::Scan(Measurement measurement) : Measurement(std::move(measurement)) {
  const std::optional<OutputShape> shape = scan_shape(*this);
  SIMVIS_ASSERT(shape.has_value());
  rings = shape->rows;
  beams = shape->columns;
  const auto is_channel = [&](const MeasuredArray& each) {
    return each.name != kRange && each.name != kRangeBound && !is_beam_layout(each) && each.shape == *shape &&
           each.held_type() == ValueType::f64;
  };
  const auto first = std::stable_partition(arrays.begin(), arrays.end(), std::not_fn(is_channel));
  first_channel_ = static_cast<std::size_t>(first - arrays.begin());
  view_arrays();
}

void Scan::view_arrays() {
  range_m = numbers_of<float>(find(kRange));
  error_bound_m = numbers_of<float>(find(kRangeBound));
  azimuth_rad = numbers_of<double>(find(kAzimuth));
  elevation_rad = numbers_of<double>(find(kElevation));
  ring = numbers_of<std::uint32_t>(find(kRing), {rings, beams});
  origin_m = numbers_of<double>(find(kBeamOrigin), {rings, beams, 3});
}

// Replaces the array of this name, or adds it in front of the channels.
void Scan::put(std::string_view name, const OutputShape& shape, MeasuredNumbers numbers) {
  MeasuredArray array = scan_array(name, shape, std::move(numbers));
  const auto found = std::ranges::find(arrays, name, &MeasuredArray::name);
  if (found != arrays.end()) {
    *found = std::move(array);
  } else {
    arrays.insert(arrays.begin() + static_cast<std::ptrdiff_t>(first_channel_++), std::move(array));
  }
  view_arrays();
}

void Scan::set_angles(SharedArray<double> azimuths_rad, SharedArray<double> elevations_rad,
                      SharedArray<double> azimuths_deg, SharedArray<double> elevations_deg) {
  const OutputShape azimuths{azimuths_rad.size() == beams ? 1 : rings, beams},
      elevations{rings, elevations_rad.size() == rings ? 1 : beams};
  put(kAzimuth, azimuths, std::move(azimuths_rad));
  put(kElevation, elevations, std::move(elevations_rad));
  if (!azimuths_deg.empty()) put(kAzimuthDeg, azimuths, std::move(azimuths_deg));
  if (!elevations_deg.empty()) put(kElevationDeg, elevations, std::move(elevations_deg));
}

void Scan::set_origins(SharedArray<double> origins_m) { put(kBeamOrigin, {rings, beams, 3}, std::move(origins_m)); }

void Scan::set_rings(SharedArray<std::uint32_t> rings_of_beams) {
  put(kRing, {rings, beams}, std::move(rings_of_beams));
}

Scan::Ranges Scan::edit_ranges() { return write_ranges(&SharedArray<float>::edit); }
Scan::Ranges Scan::overwrite_ranges() { return write_ranges(&SharedArray<float>::overwrite); }

Scan::Ranges Scan::write_ranges(std::vector<float>& (SharedArray<float>::*access)()) {
  const auto numbers = [&](std::string_view name, SharedNumbers<float>& view) {
    const auto array = std::ranges::find(arrays, name, &MeasuredArray::name);
    auto& held = std::get<SharedArray<float>>(array->numbers);
    view = {};  // else the view counts as a copy that holds the numbers
    std::vector<float>& all = (held.*access)();
    all.resize(size_product({rings, beams}));
    array->shape = {rings, beams};
    view = held;
    return std::span(all);
  };
  return {numbers(kRange, range_m), numbers(kRangeBound, error_bound_m)};
}

void Scan::add_channel(const TableColumn& column, std::vector<double> values) {
  const OutputShape shape = values.empty() ? OutputShape{0, 0} : OutputShape{rings, beams};
  arrays.push_back({column_outputs({&column, 1}, OutputKind::scan_column, shape).front(), std::move(values)});
}

void Scan::clear_channels() {
  arrays.erase(arrays.begin() + static_cast<std::ptrdiff_t>(first_channel_), arrays.end());
}

SharedNumbers<double> Scan::channel(std::string_view name) const {
  const auto found = std::ranges::find(channels(), name, &MeasuredArray::name);
  return numbers_of<double>(found == channels().end() ? nullptr : &*found);
}

std::optional<Scan> to_scan(Measurement measurement) {
  if (!scan_shape(measurement)) return std::nullopt;
  return Scan(std::move(measurement));
}

}  // namespace simvis
