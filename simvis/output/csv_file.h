// A CSV table that grows row by row and appears complete at the end of the run.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/sensor.h>
#include "simvis/output/atomic_file.h"

namespace simvis {

/// The number format of a column. Numbers are printed as by printf in the C locale: infinities as "inf" and "-inf", NaN
/// as an empty cell.
struct NumberFormat {
  enum class Style { general, fixed, scientific, integer } style = Style::general;
  int precision = 9;
};

/// Parses the format of a column: "%.Ng", "%.Nf" or "%.Ne" with N from 0 to 40, or "%lld" if the column is `integer`.
/// Throws InputError for any other format, because plug-ins also define columns.
NumberFormat number_format(const TableColumn& column);

void append_number(std::string& text, const NumberFormat& format, double value);

/// Formats `values` as lines. The columns of each row are `front` followed by the next values; `values` contains only
/// whole rows.
std::string format_rows(std::span<const NumberFormat> formats, std::span<const double> front,
                        std::span<const double> values);

/// Rows are written to a temporary file as they arrive (see AtomicFile; its errors are thrown).
class CsvFile {
 public:
  CsvFile(const std::filesystem::path& path, std::span<const TableColumn> columns);

  /// The formats of the columns, for format_rows().
  const std::vector<NumberFormat>& formats() const { return formats_; }
  void add(std::string_view lines);
  void commit();

 private:
  void flush();

  AtomicFile file_;
  std::vector<NumberFormat> formats_;
  std::string buffer_;
};

}  // namespace simvis
