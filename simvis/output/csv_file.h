// A table that grows by rows and appears whole when the run ends.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/sensor.h>
#include "simvis/output/atomic_file.h"

namespace simvis {

/// How numbers are printed, as printf would print them in the C locale: infinities as "inf" and "-inf", NaN as an
/// empty cell.
struct NumberFormat {
  enum class Style { general, fixed, scientific, integer } style = Style::general;
  int precision = 9;
};

/// The format of a column: "%.Ng", "%.Nf" or "%.Ne" with N from 0 to 40, or "%lld" where it is `integer`. Throws
/// InputError for anything else: columns come from plug-ins as well.
NumberFormat number_format(const TableColumn& column);

void append_number(std::string& text, const NumberFormat& format, double value);

/// `values` as lines: whole rows, a multiple of the number of columns less `front.size()`, which stands before each.
std::string format_rows(std::span<const NumberFormat> formats, std::span<const double> front,
                        std::span<const double> values);

/// Rows go to the disk as they come, under a temporary name (see AtomicFile, whose errors it throws).
class CsvFile {
 public:
  CsvFile(const std::filesystem::path& path, std::span<const TableColumn> columns);

  /// Of the columns, for format_rows().
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
