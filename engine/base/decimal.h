// Numbers in texts, with the same characters in every locale of the process.
#pragma once

#include <charconv>
#include <string>

namespace simvis {

/// Writes a number as printf() does in the C locale: `general` as "%.Pg", `fixed` as "%.Pf", `scientific` as "%.Pe".
inline std::string decimal(double value, int precision, std::chars_format format = std::chars_format::general) {
  char text[400];  // a sign, 309 digits before the point, the point, and the decimals
  const std::to_chars_result end = std::to_chars(text, text + sizeof text, value, format, precision);
  return {text, end.ptr};
}

}  // namespace simvis
