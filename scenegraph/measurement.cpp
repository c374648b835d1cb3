#include <simvis/measurement.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/base/assert.h"

namespace simvis {

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

Reading::Reading(std::span<const TableColumn> columns, std::vector<double> values, bool one_row) {
  for (OutputSpec& output :
       column_outputs(columns, one_row ? OutputKind::scalar : OutputKind::table_column, {0, 1, 1})) {
    arrays.push_back({std::move(output), SharedArray<double>(), arrays.size(), columns.size()});
  }
  if (!values.empty()) set_values([&](std::vector<double>& all) { all = std::move(values); });
}

const std::vector<double>& Reading::values() const {
  static const std::vector<double> none;
  return arrays.empty() ? none : std::get<SharedArray<double>>(arrays.front().numbers).numbers();
}

void Reading::set_values(const std::function<void(std::vector<double>&)>& fill) {
  SIMVIS_ASSERT(!arrays.empty());
  SharedArray<double> values = std::get<SharedArray<double>>(std::move(arrays.front().numbers));
  for (MeasuredArray& each : arrays) each.numbers = SharedArray<double>();
  fill(values.overwrite());
  SIMVIS_ASSERT(values.size() % arrays.size() == 0);
  for (MeasuredArray& each : arrays) {
    each.numbers = values;
    each.shape.rows = static_cast<std::uint32_t>(values.size() / arrays.size());
  }
  arrays.front().numbers = std::move(values);  // with the memory that it may use again
}

std::optional<double> Reading::find(std::string_view column, std::size_t row) const {
  const MeasuredArray* const found = Measurement::find(column);
  return found != nullptr && row < rows() ? std::optional(found->number(row)) : std::nullopt;
}

std::optional<double> Reading::constant(std::string_view name) const {
  const auto found = std::ranges::find(constants, name, &NamedValue::name);
  return found == constants.end() ? std::nullopt : std::optional(found->value);
}

MeasuredArray image_array(OutputSpec output, const Image& image) {
  output.shape = {image.height, image.width, image.channels};
  return {std::move(output), image.pixels};
}

MeasuredArray image_array(std::string name, const Image& image, ImageContent content, std::string unit,
                          std::string view) {
  return image_array({.name = std::move(name),
                      .kind = OutputKind::image,
                      .value_type = ValueType::f32,
                      .content = content,
                      .unit = std::move(unit),
                      .view = std::move(view)},
                     image);
}

std::optional<Image> to_image(const MeasuredArray& array) {
  const auto* const pixels = std::get_if<SharedArray<float>>(&array.numbers);
  if (array.kind != OutputKind::image || pixels == nullptr) return std::nullopt;
  return Image{array.shape.columns, array.shape.rows, array.shape.channels, *pixels};
}

}  // namespace simvis
