// Text in UTF-16.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace simvis {

enum class Utf16 : std::uint8_t { little, big };

/// UTF-16 shows in a byte order mark or in a zero byte beside the first character, which is ASCII in all formats that
/// this program reads. Empty: the text is something else.
std::optional<Utf16> utf16_of(std::string_view bytes);

/// Halves of characters become U+FFFD. The byte order mark stays.
std::string utf8_of_utf16(std::string_view bytes, Utf16 order);

void append_utf8(std::string& text, char32_t code);

inline constexpr std::string_view kUtf8Mark = "\xef\xbb\xbf";

}  // namespace simvis
