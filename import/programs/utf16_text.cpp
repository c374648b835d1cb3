#include "import/programs/utf16_text.h"

namespace simvis {
namespace {

constexpr char32_t kReplacement = 0xFFFD;

}  // namespace

std::optional<Utf16> utf16_of(std::string_view bytes) {
  using namespace std::string_view_literals;
  if (bytes.size() < 2) return std::nullopt;
  if (bytes.starts_with("\xff\xfe"sv) || (bytes[0] != 0 && bytes[1] == 0)) return Utf16::little;
  if (bytes.starts_with("\xfe\xff"sv) || (bytes[0] == 0 && bytes[1] != 0)) return Utf16::big;
  return std::nullopt;
}

std::string utf8_of_utf16(std::string_view bytes, Utf16 order) {
  const auto unit = [&](std::size_t i) -> char32_t {
    if (i + 1 >= bytes.size()) return 0;
    const auto first = static_cast<unsigned char>(bytes[i]), second = static_cast<unsigned char>(bytes[i + 1]);
    return order == Utf16::little ? first | second << 8 : first << 8 | second;
  };
  std::string text;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    char32_t code = unit(i);
    const bool is_high = code >= 0xd800 && code < 0xdc00, is_low = code >= 0xdc00 && code < 0xe000;
    const char32_t next = is_high ? unit(i + 2) : 0;
    if (next >= 0xdc00 && next < 0xe000) {
      code = 0x10000 + ((code - 0xd800) << 10) + (next - 0xdc00);
      i += 2;
    } else if (is_high || is_low) {
      code = kReplacement;
    }
    append_utf8(text, code);
  }
  return text;
}

void append_utf8(std::string& text, char32_t code) {
  const auto tail = [code](int shift) { return static_cast<char>(0x80 | (code >> shift & 0x3f)); };
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += {static_cast<char>(0xc0 | code >> 6), tail(0)};
  } else if (code < 0x10000) {
    text += {static_cast<char>(0xe0 | code >> 12), tail(6), tail(0)};
  } else {
    text += {static_cast<char>(0xf0 | code >> 18), tail(12), tail(6), tail(0)};
  }
}

}  // namespace simvis
