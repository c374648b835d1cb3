#include "sensors/output_check.h"

#include <algorithm>
#include <optional>
#include <variant>

#include <simvis/location.h>
#include <simvis/sensor.h>
#include "sensors/measured_table.h"

namespace simvis {
namespace {

// Tables of doubles have columns of all types.
bool may_hold(const MeasuredArray& array, ValueType type) {
  const ValueType held = array.held_type();
  if (type == ValueType::i64) return held == ValueType::f64;
  return held == type || (array.kind != OutputKind::image && held == ValueType::f64);
}

bool fits(const OutputShape& spec, const OutputShape& shape) {
  const auto same = [](std::uint32_t promised, std::uint32_t given) { return promised == 0 || promised == given; };
  return same(spec.rows, shape.rows) && same(spec.columns, shape.columns) && same(spec.channels, shape.channels);
}

std::size_t held_numbers(const MeasuredArray& array) {
  return std::visit([](const auto& all) { return all.size(); }, array.numbers);
}

// Readers of a column take as many numbers as it has rows, readers of a single number one.
std::string difference_of_form(const MeasuredArray& array) {
  const OutputShape& shape = array.shape;
  const bool is_single = array.kind == OutputKind::scalar, is_column = array.kind == OutputKind::table_column;
  const bool fits = is_single   ? array.count() == 0 || shape == OutputShape{}
                    : is_column ? shape.rows == 0 || (shape.columns == 1 && shape.channels == 1)
                                : true;
  return fits ? "" : "shape " + to_string(shape) + ", expected " + (is_single ? "1" : "n");
}

// Files, messages and arrays of images and beams are the numbers as they lie in memory.
std::string difference_of_places(const MeasuredArray& array) {
  const std::size_t held = held_numbers(array), count = array.count();
  const bool is_table = array.kind == OutputKind::table_column || array.kind == OutputKind::scalar;
  const bool fits = is_table ? count == 0 || (array.stride > 0 && array.first < held &&
                                              (count - 1) <= (held - 1 - array.first) / array.stride)
                             : array.first == 0 && array.stride == 1 && held == count;
  if (fits) return "";
  return "shape " + to_string(array.shape) + " with first " + std::to_string(array.first) + " and stride " +
         std::to_string(array.stride) + " in an array of " + std::to_string(held) + " numbers, expected " +
         (is_table ? "places in the array" : "first 0, stride 1 and " + std::to_string(count) + " numbers");
}

// Encoders of pictures, messages and pages have these forms only.
std::string difference_of_content(const MeasuredArray& array) {
  if (array.content == ImageContent::numbers) return "";
  const std::uint32_t channels = array.content == ImageContent::color ? 4 : 1;
  const ValueType type = array.content == ImageContent::counts ? ValueType::u32 : ValueType::f32;
  const bool fits = array.kind == OutputKind::image && array.value_type == type &&
                    (array.shape.channels == channels || array.count() == 0);
  if (fits) return "";
  return "content of colour, depth, disparity or counts in " + std::to_string(array.shape.channels) + " channels of " +
         std::string(to_string(array.value_type)) +
         ", expected an image of f32 (counts: of u32), 4 channels of colour or 1 of the others";
}

std::string difference_of_views(const Measurement& measurement) {
  for (const MeasuredArray& color : measurement.arrays) {
    if (color.content == ImageContent::disparity && measurement.calibration("right") == nullptr) {
      return "output " + in_quotes(color.name) + ": a disparity, expected a calibration of a view \"right\"";
    }
    if (color.content != ImageContent::color) continue;
    for (const MeasuredArray& depth : measurement.arrays) {
      const bool differs = depth.content == ImageContent::depth && depth.view == color.view &&
                           (depth.shape.rows != color.shape.rows || depth.shape.columns != color.shape.columns);
      if (!differs) continue;
      return "outputs " + in_quotes(color.name) + " and " + in_quotes(depth.name) + " of one view: shapes " +
             to_string(color.shape) + " and " + to_string(depth.shape) + ", expected equal rows and columns";
    }
  }
  return "";
}

std::string difference_of_parts(const Sensor& sensor, const Measurement& measurement) {
  if (const std::string views = difference_of_views(measurement); !views.empty()) return views;
  if (!fits_together(measurement)) {
    return "its columns have different lengths, or are not all of a scan; expected one table, or the ranges, bounds "
           "and "
           "angles of one scan";
  }
  if (const Scan* const scan = sensor.scan()) {
    const bool fits = std::ranges::all_of(scan->arrays, [&](const MeasuredArray& each) {
      const MeasuredArray* const found = measurement.find(each.name);
      return found != nullptr && found->shape == each.shape;
    });
    if (!fits) return "its scan has other sizes than its measurement";
  }
  if (const Reading* const reading = sensor.reading()) {
    // Images stand behind the columns.
    const auto columns = static_cast<std::size_t>(std::ranges::count_if(
        measurement.arrays, [](const MeasuredArray& each) { return each.kind != OutputKind::image; }));
    if (reading->arrays.size() != columns) return "its reading has other columns than its measurement";
  }
  return "";
}

// Arrays are in the order of the outputs, some of which have none: the search goes on behind the last one.
const OutputSpec* find_next(std::span<const OutputSpec> outputs, std::string_view name, std::size_t& next) {
  for (std::size_t i = next; i < outputs.size(); ++i) {
    if (outputs[i].name != name) continue;
    next = i + 1;
    return &outputs[i];
  }
  return find_output(outputs, name);
}

std::string difference_of_output(const MeasuredArray& array, const OutputSpec& promised, bool has_measured) {
  std::string different = output_difference(array, promised);
  if (different.empty() && has_measured && array.kind == OutputKind::image && array.count() == 0) {
    return "an image without pixels";
  }
  return different;
}

}  // namespace

std::string output_difference(const MeasuredArray& array, const OutputSpec& spec) {
  const auto differ = [](const std::string& seen, const std::string& allowed) {
    return seen + ", expected " + allowed;
  };
  if (array.kind != spec.kind) return differ(std::string(to_string(array.kind)), std::string(to_string(spec.kind)));
  if (array.unit != spec.unit) return differ("unit " + in_quotes(array.unit), in_quotes(spec.unit));
  if (array.value_type != spec.value_type || !may_hold(array, spec.value_type)) {
    const ValueType seen = array.value_type != spec.value_type ? array.value_type : array.held_type();
    return differ("numbers of " + std::string(to_string(seen)), std::string(to_string(spec.value_type)));
  }
  if (const std::string form = difference_of_form(array); !form.empty()) return form;
  if (const std::string places = difference_of_places(array); !places.empty()) return places;
  if (array.count() > 0 && !fits(spec.shape, array.shape)) {
    return differ("shape " + to_string(array.shape), to_string(spec.shape));
  }
  if (array.content != spec.content) return "another content of the image than its type lists";
  return difference_of_content(array);
}

// What arrives from a host has the format of text that the host's program gave it, if any.
void describe(Measurement& measurement, std::span<const OutputSpec> outputs) {
  std::size_t next = 0;
  for (MeasuredArray& each : measurement.arrays) {
    if (const OutputSpec* const listed = find_next(outputs, each.name, next)) describe(each, *listed);
  }
}

void describe(MeasuredArray& array, const OutputSpec& spec) {
  OutputSpec described = spec;
  described.name = std::move(array.name);
  described.shape = array.shape;
  described.format = std::move(array.format);
  described.view = std::move(array.view);
  static_cast<OutputSpec&>(array) = std::move(described);
}

std::string measurement_difference(const Sensor& sensor, const Measurement& measurement,
                                   std::span<const OutputSpec> outputs, bool has_measured) {
  std::size_t next = 0;
  for (const MeasuredArray& each : measurement.arrays) {
    const OutputSpec* const listed = find_next(outputs, each.name, next);
    const std::string different = listed == nullptr && !outputs.empty()
                                      ? "it is not among those that its type lists"
                                      : difference_of_output(each, listed == nullptr ? each : *listed, has_measured);
    if (!different.empty()) return "output " + in_quotes(each.name) + ": " + different;
  }
  return has_measured ? difference_of_parts(sensor, measurement) : "";
}

}  // namespace simvis
