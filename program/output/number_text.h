// Numbers as text for tables.
#pragma once

#include <string>

#include <simvis/sensor.h>

namespace simvis {

/// The number format of a column. Numbers are printed as by printf in the C locale: infinities as "inf" and "-inf", NaN
/// as an empty cell. `exact` is the shortest decimal that reads back to the same double.
struct NumberFormat {
  enum class Style { general, fixed, scientific, integer, exact } style = Style::general;
  int precision = 9;
};

/// Parses the format of a column: "%.Ng", "%.Nf" or "%.Ne" with N from 0 to 40, kExactFormat, or "%lld" if the column
/// is `integer`. Throws InputError for any other format, because plug-ins also define columns.
NumberFormat number_format(const TableColumn& column);

void append_number(std::string& text, const NumberFormat& format, double value);
std::string number_cell(const NumberFormat& format, double value);

/// Appends the shortest decimal that reads back to the same double.
void append_exact(std::string& text, double value);

/// Appends a bound on the error of `value`, which is printed as `value_format`. The decimal is rounded up and covers
/// the rounding of the decimal of `value`: for every x with |value - x| <= bound, |decimal of value - x| <= decimal of
/// bound, where both decimals are read as doubles and the difference is taken in double.
void append_bound(std::string& text, const NumberFormat& format, double bound, const NumberFormat& value_format,
                  double value);

}  // namespace simvis
