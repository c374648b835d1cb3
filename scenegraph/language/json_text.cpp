#include "scenegraph/language/json_text.h"

#include <algorithm>
#include <cstddef>

#include "scenegraph/language/source_text.h"

namespace simvis {

namespace {

constexpr std::string_view kReplaced = "\xef\xbf\xbd";  // U+FFFD
constexpr std::string_view kHexDigits = "0123456789ABCDEF";

void add_byte(std::string& text, char byte) {
  const auto code = static_cast<unsigned char>(byte);
  text += kReplaced;
  text += kHexDigits[code >> 4];
  text += kHexDigits[code & 15];
}

}  // namespace

std::string to_json_text(std::string_view bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes.size();) {
    const std::size_t length = text_character_length(bytes, i);
    const std::string_view character = bytes.substr(i, std::max<std::size_t>(length, 1));
    if (length == 0 || character == kReplaced) {
      for (const char byte : character) add_byte(text, byte);
    } else {
      text += character;
    }
    i += character.size();
  }
  return text;
}

std::string from_json_text(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size();) {
    const std::string_view digits = text.substr(std::min(i + kReplaced.size(), text.size()), 2);
    const std::size_t high = digits.size() == 2 ? kHexDigits.find(digits[0]) : std::string_view::npos,
                      low = digits.size() == 2 ? kHexDigits.find(digits[1]) : std::string_view::npos;
    const bool is_byte =
        text.substr(i).starts_with(kReplaced) && high != std::string_view::npos && low != std::string_view::npos;
    bytes += is_byte ? static_cast<char>(high << 4 | low) : text[i];
    i += is_byte ? kReplaced.size() + 2 : 1;
  }
  return bytes;
}

}  // namespace simvis
