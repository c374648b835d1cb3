// Scalars of YAML files, as parsers of YAML 1.1 and 1.2 read them.
#pragma once

#include <string>
#include <string_view>

#include <simvis/attributes.h>

namespace simvis {

/// A number. YAML 1.1 requires a decimal point in a float with an exponent: without one it is a text.
inline std::string yaml_number(double value) {
  std::string text = format_number(value);
  const std::size_t exponent = text.find('e');
  if (exponent != std::string::npos && text.find('.') == std::string::npos) text.insert(exponent, ".0");
  return text;
}

/// A text in quotation marks, in one line: in single ones, in which only these have a special meaning, or in double
/// ones if the text has line breaks.
inline std::string yaml_quoted(std::string_view text) {
  const bool is_one_line = text.find('\n') == text.npos;
  const char mark = is_one_line ? '\'' : '"';
  std::string quoted(1, mark);
  for (const char c : text) {
    if (c == '\n') {
      quoted += "\\n";
      continue;
    }
    if (is_one_line && c == mark) quoted += mark;
    if (!is_one_line && (c == mark || c == '\\')) quoted += '\\';
    quoted += c;
  }
  return quoted + mark;
}

}  // namespace simvis
