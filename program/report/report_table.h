// A report as a table: each column is stated once and printed as text, as CSV and as a dict of Python.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <simvis/attributes.h>
#include "program/output/number_text.h"
#include "program/output/scene_table.h"
#include "program/report/aligned_table.h"

namespace simvis {

/// NaN: there is no value.
using ReportValue = std::variant<bool, std::uint64_t, double, std::string>;

template <typename Row>
struct ReportColumn {
  const char* name;  ///< in CSV and in a dict, with the unit: "median_ms"
  ReportValue (*get)(const Row&);
  const char *head1 = nullptr, *head2 = "";   ///< of the text, one below the other; null: CSV and dict alone have it
  NumberFormat format{};                      ///< of a number in the text
  double factor = 1;                          ///< from the value to the number in the text: 100 for percent
  std::string (*text)(const Row&) = nullptr;  ///< the cell of the text; null: the number by `format`
};

/// A number in the text: NaN is a dash, and 0 is not written as 0.0e+00.
std::string report_number(const NumberFormat& format, double value);
/// The cell of a CSV file; empty if there is no value.
std::string csv_cell(const ReportValue& value);

/// An aligned table with two lines of heads.
template <typename Row>
std::string report_text(std::span<const ReportColumn<Row>> columns, std::span<const Row> rows) {
  std::vector<std::vector<std::string>> cells(rows.size() + 2);
  for (const ReportColumn<Row>& column : columns) {
    if (column.head1 == nullptr) continue;
    cells[0].emplace_back(column.head1);
    cells[1].emplace_back(column.head2);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (column.text != nullptr) {
        cells[i + 2].push_back(column.text(rows[i]));
        continue;
      }
      const ReportValue value = column.get(rows[i]);
      const auto* const number = std::get_if<double>(&value);
      cells[i + 2].push_back(number ? report_number(column.format, column.factor * *number) : csv_cell(value));
    }
  }
  return aligned(cells);
}

/// A line of column names, then one line for each row.
template <typename Row>
std::string report_csv(std::span<const ReportColumn<Row>> columns, std::span<const Row> rows) {
  std::string text;
  const auto line = [&](const auto& cell_of) {
    for (std::size_t i = 0; i < columns.size(); ++i) text += (i == 0 ? "" : ",") + cell_of(columns[i]);
    text += '\n';
  };
  line([](const ReportColumn<Row>& column) { return std::string(column.name); });
  for (const Row& row : rows) line([&](const ReportColumn<Row>& column) { return csv_cell(column.get(row)); });
  return text;
}

}  // namespace simvis
