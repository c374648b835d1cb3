// Control characters in names and in messages of other libraries.
#pragma once

#include <algorithm>
#include <string>

namespace simvis {

/// Whether the byte is a control character of ASCII; line ends and tabs are.
inline bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

/// The text with a space for each control character.
inline std::string on_one_line(std::string text) {
  std::ranges::replace_if(text, is_control, ' ');
  return text;
}

}  // namespace simvis
