// What a sensor measured in one frame: arrays of numbers by the names of its outputs, with stamp, pose and calibration.
// Files, messages, shared memory, pages and Python loop over the arrays; none of them has a list of outputs of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <simvis/export.h>
#include <simvis/image.h>
#include <simvis/output_spec.h>
#include <simvis/shared_array.h>
#include <simvis/size_product.h>

namespace simvis {

/// Numbers of one type.
using MeasuredNumbers = std::variant<SharedArray<float>, SharedArray<double>, SharedArray<std::uint8_t>,
                                     SharedArray<std::uint32_t>, SharedArray<std::int32_t>>;

/// Their types, in the same order.
inline constexpr ValueType kHeldTypes[] = {ValueType::f32, ValueType::f64, ValueType::u8, ValueType::u32,
                                           ValueType::i32};
static_assert(std::size(kHeldTypes) == std::variant_size_v<MeasuredNumbers>);

/// One output and its numbers. Simulation::measurement() gives all that the sensor's type lists of the output; from
/// Sensor::measurement(), what only the type knows, such as the message, may be empty. `shape` is that of this
/// measurement.
///
/// Shape    rows by rows, then columns, then channels: number (row, column, channel) is the one at
///          (row * shape.columns + column) * shape.channels + channel. A column of a scan that is the same for all
///          rings, or for all beams of a ring, has one row, or one column.
/// Special  before the first measurement there are no numbers, and the shape has none.
/// Type     those of scans and tables may be held as doubles, whatever `value_type` is.
struct MeasuredArray : OutputSpec {
  MeasuredNumbers numbers{};  ///< those of the output are among them:
  std::size_t first = 0,      ///< place of the first one; 0 in images and scans
      stride = 1;             ///< from one to the next; 1 in images and scans

  /// How many numbers it has; see size_product().
  std::size_t count() const { return size_product({shape.rows, shape.columns, shape.channels}); }
  /// The type of `numbers`.
  ValueType held_type() const { return kHeldTypes[numbers.index()]; }
  /// Bytes of the array that holds the numbers.
  std::size_t bytes() const {
    return std::visit([](const auto& all) { return all.size() * sizeof *all.data(); }, numbers);
  }
  /// Number `i`, which must be below count(), as a double: exact, because no type is wider.
  double number(std::size_t i) const {
    return std::visit([&](const auto& all) { return static_cast<double>(all[first + i * stride]); }, numbers);
  }
};

/// The calibration of the images of one view of a camera.
struct Calibration {
  std::string view;          ///< as OutputSpec::view
  CameraCalibration camera;  ///< of its images
};

/// A number that takes long to compute, so the reader does it. The function may be called in any thread, and works with
/// the numbers of its measurement.
struct NumberOnRequest {
  std::string name;                 ///< as MeasuredArray::name
  std::string unit;                 ///< as MeasuredArray::unit
  std::function<double()> compute;  ///< NaN before the first measurement
};

/// One number that a sensor measured.
struct NamedValue {
  std::string_view name;  ///< with its unit, as in "range_m"; static text
  double value = 0;       ///< NaN before the first measurement
};

/// What a sensor measured in one frame. Copies share the numbers, which stay as they are.
///
/// Threads  as a value.
struct SIMVIS_API Measurement {
  std::int64_t time_ns = 0;             ///< simulated time; 0 before the first measurement
  glm::dmat4 world_from_sensor{1.0};    ///< rigid, at that time; the identity before the first measurement
  std::vector<MeasuredArray> arrays{};  ///< in the order of the outputs
  /// Of the views of a camera; null: there are none. The same in all measurements.
  std::shared_ptr<const std::vector<Calibration>> calibrations{};
  std::vector<NamedValue> constants{};        ///< beside the outputs, such as limits and variances, for messages
  std::vector<NumberOnRequest> on_request{};  ///< as Sensor::on_request(); Simulation::measurement() adds them

  /// The array of this name; null if there is none. The pointer is valid until `arrays` changes.
  const MeasuredArray* find(std::string_view name) const;
  /// The calibration of this view; null if there is none. It is valid as long as `calibrations`.
  const CameraCalibration* calibration(std::string_view view) const;
  /// The single number of this name; it is computed if it is on request. Empty if there is none.
  std::optional<double> value(std::string_view name) const;
};

/// The measurement of a sensor that gives neither images nor a scan: a table, mostly of one row. Its arrays are the
/// columns; they share one block of numbers. Without a measurement there are no rows.
struct SIMVIS_API Reading : Measurement {
  Reading() = default;  ///< no columns
  /// Rows of these columns, row by row; NaN: no value. With `one_row` the number of rows never varies, and each column
  /// is a number of its own.
  explicit Reading(std::span<const TableColumn> columns, std::vector<double> values = {}, bool one_row = false);

  /// The number of rows.
  std::size_t rows() const { return arrays.empty() ? 0 : arrays.front().shape.rows; }
  /// All values, row by row; valid as long as the reading does not change.
  const std::vector<double>& values() const;
  /// Replaces all rows: `fill` gets the vector of all values, row by row. Memory that no copy holds is used again.
  /// There must be a column; the number of values must be a multiple of the number of columns (asserted).
  void set_values(const std::function<void(std::vector<double>&)>& fill);
  /// The value in the column of this name; empty if there is no such column or row.
  std::optional<double> find(std::string_view column, std::size_t row = 0) const;
  /// The constant of this name; empty if there is none.
  std::optional<double> constant(std::string_view name) const;
};

/// The array of an image of floats.
SIMVIS_API MeasuredArray image_array(OutputSpec output, const Image& image);
/// As above, of an output that is described by these alone.
SIMVIS_API MeasuredArray image_array(std::string name, const Image& image, ImageContent content, std::string unit = {},
                                     std::string view = {});
/// The image of an array; empty if the array is no image of floats.
SIMVIS_API std::optional<Image> to_image(const MeasuredArray& array);

/// The name of the array of the origins of beams: x, y and z of each, if not all start at the sensor's.
inline constexpr const char* kBeamOrigin = "origin_m";

/// The outputs of a scanner whose measurements are scans (<simvis/scan.h>): without its channels.
SIMVIS_API std::vector<OutputSpec> scan_outputs(std::uint32_t rings, std::uint32_t beams);

}  // namespace simvis
