// The text of CSV tables.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <simvis/sensor.h>
#include "program/output/number_text.h"

namespace simvis {

/// One column as text.
struct CsvColumn {
  NumberFormat format;
  std::size_t bound_of;  ///< index of the column whose errors it bounds, to its left; its own index: of none
};

/// Throws InputError for a wrong format, and for a bound of a column that is not to its left.
std::vector<CsvColumn> csv_columns(std::span<const TableColumn> columns);

/// The heading: the names, separated by commas, and the end of the line.
std::string csv_heading(std::span<const TableColumn> columns);

/// Formats `values` as lines. The columns of each row are `front` followed by the next values; `values` contains only
/// whole rows.
std::string format_rows(std::span<const CsvColumn> columns, std::span<const double> front,
                        std::span<const double> values);

}  // namespace simvis
