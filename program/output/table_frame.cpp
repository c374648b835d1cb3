#include "program/output/table_frame.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/binary_numbers.h"
#include "program/output/number_text.h"

namespace simvis {

std::optional<std::size_t> TableFrame::find(std::string_view name) const {
  const auto found = std::ranges::find(columns, name, &TableColumn::name);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

std::optional<PointColumns> point_columns(const TableFrame& table) {
  const auto x = table.find("x_m"), y = table.find("y_m"), z = table.find("z_m");
  if (!x || !y || !z) return std::nullopt;
  return PointColumns{*x, *y, *z};
}

NumberType number_type(const TableColumn& column) {
  if (column.integer) return NumberType::int64;
  const NumberFormat format = number_format(column);
  return format.style == NumberFormat::Style::general && format.precision <= 9 ? NumberType::float32
                                                                               : NumberType::float64;
}

std::size_t size_of(NumberType type) { return type == NumberType::int32 || type == NumberType::float32 ? 4 : 8; }

void append_as(std::string& bytes, NumberType type, double value) {
  switch (type) {
    case NumberType::int32:
      return append_binary(bytes, std::isnan(value) ? std::int32_t{-1} : static_cast<std::int32_t>(value));
    case NumberType::int64:
      return append_binary(bytes, std::isnan(value) ? std::int64_t{-1} : static_cast<std::int64_t>(value));
    case NumberType::float32:
      return append_binary(bytes, static_cast<float>(value));
    case NumberType::float64:
      return append_binary(bytes, value);
  }
}

std::vector<std::size_t> rows_with_points(const TableFrame& table, const PointColumns& points) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (std::isfinite(table.at(row, points.x)) && std::isfinite(table.at(row, points.y)) &&
        std::isfinite(table.at(row, points.z))) {
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace simvis
