#include "simvis/output/csv_file.h"

#include <charconv>
#include <cmath>

#include <simvis/error.h>
#include "engine/base/assert.h"

namespace simvis {

namespace {

constexpr int kMaxPrecision = 40;
// The longest number, in fixed format: a sign, 309 digits before the point, the point and the decimals.
constexpr std::size_t kMaxNumberLength = 400;
constexpr std::size_t kFlushBytes = 1u << 20;

}  // namespace

NumberFormat number_format(const TableColumn& column) {
  const std::string& text = column.format;
  if (column.integer && text == "%lld") return {NumberFormat::Style::integer, 0};
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
                   (column.integer ? "\"%lld\"" : "\"%.Ng\", \"%.Nf\" or \"%.Ne\""));
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
  }
  SIMVIS_ASSERT(end.ec == std::errc());
  text.append(number, end.ptr);
}

std::string format_rows(std::span<const NumberFormat> formats, std::span<const double> front,
                        std::span<const double> values) {
  SIMVIS_ASSERT(front.size() < formats.size());
  const std::size_t width = formats.size() - front.size();
  SIMVIS_ASSERT(values.size() % width == 0);
  std::string start;
  for (std::size_t c = 0; c < front.size(); ++c) {
    append_number(start, formats[c], front[c]);
    start += ',';
  }
  std::string lines;
  for (std::size_t row = 0; row < values.size(); row += width) {
    lines += start;
    for (std::size_t c = 0; c < width; ++c) {
      if (c > 0) lines += ',';
      append_number(lines, formats[front.size() + c], values[row + c]);
    }
    lines += '\n';
  }
  return lines;
}

CsvFile::CsvFile(const std::filesystem::path& path, std::span<const TableColumn> columns) : file_(path) {
  for (const TableColumn& column : columns) {
    if (!formats_.empty()) buffer_ += ',';
    formats_.push_back(number_format(column));
    buffer_ += column.name;
  }
  buffer_ += '\n';
}

void CsvFile::add(std::string_view lines) {
  buffer_ += lines;
  if (buffer_.size() >= kFlushBytes) flush();
}

void CsvFile::flush() {
  file_.write(buffer_);
  buffer_.clear();
}

void CsvFile::commit() {
  flush();
  file_.commit();
}

}  // namespace simvis
