#include "program/output/number_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <simvis/error.h>
#include "engine/base/assert.h"

namespace simvis {

namespace {

constexpr int kMaxPrecision = 40;
// The longest number, in fixed format: a sign, 309 digits before the point, the point and the decimals.
constexpr std::size_t kMaxNumberLength = 400;

double read_back(const std::string& text, std::size_t from) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data() + from, text.data() + text.size(), value);
  SIMVIS_ASSERT(error == std::errc() && end == text.data() + text.size());
  return value;
}

/// The distance between two decimals of this format beside `value`.
double decimal_step(const NumberFormat& format, double value) {
  if (format.style == NumberFormat::Style::fixed) return std::pow(10.0, -format.precision);
  const int digits =
      format.style == NumberFormat::Style::general ? std::max(format.precision, 1) : format.precision + 1;
  return std::max(std::pow(10.0, std::floor(std::log10(value)) + 1 - digits),
                  std::numeric_limits<double>::denorm_min());
}

/// Appends a positive number, not below `value` when it is read back.
void append_rounded_up(std::string& text, const NumberFormat& format, double value) {
  const std::size_t start = text.size();
  append_number(text, format, value);
  for (int half_steps = 1; read_back(text, start) < value; ++half_steps) {
    text.resize(start);
    append_number(text, format, value + half_steps * decimal_step(format, value) / 2);
  }
}

}  // namespace

NumberFormat number_format(const TableColumn& column) {
  const std::string& text = column.format;
  if (column.integer && text == "%lld") return {NumberFormat::Style::integer, 0};
  if (!column.integer && text == kExactFormat) return {NumberFormat::Style::exact, 0};
  int precision = -1;
  if (!column.integer && text.starts_with("%.")) {
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + 2, end, precision);
    if (error == std::errc() && rest + 1 == end && precision >= 0 && precision <= kMaxPrecision) {
      if (*rest == 'g') return {NumberFormat::Style::general, precision};
      if (*rest == 'f') return {NumberFormat::Style::fixed, precision};
      if (*rest == 'e') return {NumberFormat::Style::scientific, precision};
    }
  }
  throw InputError("column \"" + column.name + "\" has the format \"" + text + "\", expected " +
                   (column.integer ? "\"%lld\"" : "\"%.Ng\", \"%.Nf\", \"%.Ne\" or \"exact\""));
}

void append_number(std::string& text, const NumberFormat& format, double value) {
  if (std::isnan(value)) return;
  if (std::isinf(value)) {
    text += value > 0 ? "inf" : "-inf";
    return;
  }
  char number[kMaxNumberLength];
  std::to_chars_result end{};
  switch (format.style) {
    case NumberFormat::Style::general:
      end = std::to_chars(number, std::end(number), value, std::chars_format::general, format.precision);
      break;
    case NumberFormat::Style::fixed:
      end = std::to_chars(number, std::end(number), value, std::chars_format::fixed, format.precision);
      break;
    case NumberFormat::Style::scientific:
      end = std::to_chars(number, std::end(number), value, std::chars_format::scientific, format.precision);
      break;
    case NumberFormat::Style::integer:
      // Integral doubles of any size, printed without a fraction.
      end = std::to_chars(number, std::end(number), value, std::chars_format::fixed, 0);
      break;
    case NumberFormat::Style::exact:
      return append_exact(text, value);
  }
  SIMVIS_ASSERT(end.ec == std::errc());
  text.append(number, end.ptr);
}

std::string number_cell(const NumberFormat& format, double value) {
  std::string text;
  append_number(text, format, value);
  return text;
}

void append_exact(std::string& text, double value) {
  char number[32];
  const std::to_chars_result end = std::to_chars(number, std::end(number), value);
  SIMVIS_ASSERT(end.ec == std::errc());
  text.append(number, end.ptr);
}

void append_bound(std::string& text, const NumberFormat& format, double bound, const NumberFormat& value_format,
                  double value) {
  if (!std::isfinite(bound) || !std::isfinite(value)) return append_number(text, format, bound);
  std::string printed;
  append_number(printed, value_format, value);
  const double decimal = read_back(printed, 0);
  double needed = bound;
  if (decimal != value) {
    // One unit in the last place of the value covers the rounding of this sum and of the reader's difference.
    needed += std::abs(decimal - value) + std::abs(decimal) * std::numeric_limits<double>::epsilon();
  }
  if (needed == 0) return append_number(text, format, 0);
  append_rounded_up(text, format, needed);
}

}  // namespace simvis
