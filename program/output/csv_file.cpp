#include "program/output/csv_file.h"

#include <algorithm>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "program/output/formats.h"

namespace simvis {

std::vector<CsvColumn> csv_columns(std::span<const TableColumn> columns) {
  std::vector<CsvColumn> result;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    std::size_t bound_of = c;
    if (const std::string& name = columns[c].bound_of; !name.empty()) {
      const auto left = columns.first(c);
      bound_of = static_cast<std::size_t>(std::ranges::find(left, name, &TableColumn::name) - left.begin());
      if (bound_of == c) {
        throw InputError("column \"" + columns[c].name + "\" bounds the errors of \"" + name +
                         "\", expected a column to its left");
      }
    }
    result.push_back({number_format(columns[c]), bound_of});
  }
  return result;
}

std::string csv_heading(std::span<const TableColumn> columns) {
  std::string line;
  for (const TableColumn& column : columns) line += (line.empty() ? "" : ",") + column.name;
  return line + '\n';
}

std::string format_rows(std::span<const CsvColumn> columns, std::span<const double> front,
                        std::span<const double> values) {
  SIMVIS_ASSERT(front.size() < columns.size());
  const std::size_t width = columns.size() - front.size();
  SIMVIS_ASSERT(values.size() % width == 0);
  std::string start;
  for (std::size_t c = 0; c < front.size(); ++c) {
    append_number(start, columns[c].format, front[c]);
    start += ',';
  }
  std::string lines;
  for (std::size_t row = 0; row < values.size(); row += width) {
    lines += start;
    for (std::size_t c = 0; c < width; ++c) {
      if (c > 0) lines += ',';
      const CsvColumn& column = columns[front.size() + c];
      const double value = values[row + c];
      if (column.bound_of >= front.size() && column.bound_of < front.size() + c) {
        append_bound(lines, column.format, value, columns[column.bound_of].format,
                     values[row + column.bound_of - front.size()]);
      } else {
        append_number(lines, column.format, value);
      }
    }
    lines += '\n';
  }
  return lines;
}

namespace {

const FormatRegistration kCsvFormat({.kind = "scan",
                                     .name = "csv",
                                     .file = "SCANNER.csv",
                                     .text = "the table of all frames, one row for each beam",
                                     .order = 0,
                                     .is_default = true});

}  // namespace

}  // namespace simvis
