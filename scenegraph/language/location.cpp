#include <simvis/location.h>

#include <array>
#include <cstdio>

#include "scenegraph/language/control_characters.h"

namespace simvis {

std::string to_string(const Location& where) {
  std::string text = where.file;
  if (where.line > 0) {
    text += ":" + std::to_string(where.line);
    if (where.column > 0) text += ":" + std::to_string(where.column);
  }
  return text;
}

void fail_at(const Location& where, std::string_view message) {
  std::string text = to_string(where);
  if (!text.empty()) text += ": ";
  text += "error: " + std::string(message);
  if (where.included_from != nullptr) text += " (included from " + *where.included_from + ")";
  throw InputError(text);
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 120;
  std::string result = "\"";
  for (const char c : text.substr(0, kLongest)) {
    if (is_control(c)) {
      std::array<char, 8> escaped{};
      std::snprintf(escaped.data(), escaped.size(), "\\x%02x", static_cast<unsigned char>(c));
      result += escaped.data();
    } else {
      if (c == '"') result += '\\';
      result += c;
    }
  }
  return result + (text.size() > kLongest ? "...\"" : "\"");
}

}  // namespace simvis
