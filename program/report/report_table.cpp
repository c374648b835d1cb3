#include "program/report/report_table.h"

namespace simvis {

std::string report_number(const NumberFormat& format, double value) {
  if (std::isnan(value)) return "-";
  return value == 0 && format.style != NumberFormat::Style::fixed ? "0" : number_cell(format, value);
}

std::string csv_cell(const ReportValue& value) {
  constexpr NumberFormat kExact{NumberFormat::Style::general, 9};
  if (const auto* const flag = std::get_if<bool>(&value)) return *flag ? "1" : "0";
  if (const auto* const count = std::get_if<std::uint64_t>(&value)) return std::to_string(*count);
  if (const auto* const number = std::get_if<double>(&value)) return number_cell(kExact, *number);
  return csv_field(std::get<std::string>(value));
}

}  // namespace simvis
