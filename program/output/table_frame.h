// The rows that a sensor adds to its table in one frame, for formats with one file per frame.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include <simvis/frame_time.h>
#include <simvis/sensor.h>

namespace simvis {

/// Rows with their columns, and when and where they were measured.
struct TableFrame {
  FrameTime time;
  glm::dmat4 world_from_sensor{1.0};
  std::vector<TableColumn> columns;
  std::vector<double> values;   ///< whole rows
  glm::uvec2 image_size_px{0};  ///< of the camera that the rows belong to; 0: of none

  std::size_t rows() const { return values.size() / columns.size(); }
  double at(std::size_t row, std::size_t column) const { return values[row * columns.size() + column]; }
  /// The index of the column of this name; empty if there is none.
  std::optional<std::size_t> find(std::string_view name) const;
};

/// The columns of points: x_m, y_m and z_m.
struct PointColumns {
  std::size_t x, y, z;
};

/// Empty if the table has no points.
std::optional<PointColumns> point_columns(const TableFrame& table);

/// How a number of a column is stored in a binary file.
enum class NumberType : std::uint8_t { int32, int64, float32, float64 };

/// Whole numbers are int64: ids have up to 32 bits. Columns that are printed with up to 9 digits are float32, which is
/// what these digits carry; a column that needs more, such as a time or an angle of a beam, is float64.
NumberType number_type(const TableColumn& column);

std::size_t size_of(NumberType type);

/// Appends a value in little-endian order. A NaN as a whole number becomes -1.
void append_as(std::string& bytes, NumberType type, double value);

/// The rows that have a point, that is whose x_m, y_m and z_m are finite.
std::vector<std::size_t> rows_with_points(const TableFrame& table, const PointColumns& points);

}  // namespace simvis
