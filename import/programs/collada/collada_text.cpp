#include "import/programs/collada/collada_text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "import/programs/utf16_text.h"

namespace simvis {
namespace {

// The characters of the bytes 0x80 to 0x9f in Windows-1252. The five bytes without one get the replacement character.
constexpr std::array<char16_t, 32> kWindows1252 = {0x20AC, 0xFFFD, 0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021,
                                                   0x02C6, 0x2030, 0x0160, 0x2039, 0x0152, 0xFFFD, 0x017D, 0xFFFD,
                                                   0xFFFD, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                                   0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0xFFFD, 0x017E, 0x0178};

char32_t windows_1252(unsigned char byte) {
  if (byte >= 0x80 && byte < 0xa0) return kWindows1252[byte - 0x80u];
  // XML has no control characters except tabs and line ends.
  const bool is_text = byte >= 0x20 || byte == '\t' || byte == '\n' || byte == '\r';
  return is_text ? byte : U' ';
}

std::string read_bytes(const AssimpFile& file) {
  const Bytes bytes = file.bytes ? *file.bytes : read_whole_file(file.file);
  return {bytes.begin(), bytes.end()};
}

// Returns whether the XML declaration names one of the 8-bit encodings of Western Europe.
bool declares_windows_1252(std::string_view bytes) {
  if (!bytes.starts_with("<?xml")) return false;
  std::string declaration(bytes.substr(0, bytes.find("?>")));
  std::ranges::transform(declaration, declaration.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return std::ranges::any_of(std::array{"iso-8859-1", "latin1", "windows-1252"}, [&](const char* name) {
    return declaration.find(std::string("\"") + name + '"') != std::string::npos ||
           declaration.find(std::string("'") + name + '\'') != std::string::npos;
  });
}

struct Repaired {
  std::string text;
  std::size_t first = 0, bytes = 0;  // place of the first byte that was replaced, in `text`; number of such bytes
};

// Characters that UTF-8 text may hold are kept; every other byte is read as Windows-1252.
Repaired utf8_of_bytes(std::string_view bytes) {
  Repaired repaired;
  for (std::size_t i = 0; i < bytes.size();) {
    if (const std::size_t length = text_character_length(bytes, i); length > 0) {
      repaired.text += bytes.substr(i, length);
      i += length;
      continue;
    }
    if (repaired.bytes++ == 0) repaired.first = repaired.text.size();
    append_utf8(repaired.text, windows_1252(static_cast<unsigned char>(bytes[i++])));
  }
  return repaired;
}

std::string utf8_of_windows_1252(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes) append_utf8(text, windows_1252(static_cast<unsigned char>(byte)));
  return text;
}

// Cuts off what follows the end of the root element, unless it is a comment, and returns how many bytes that were. Some
// files were written over longer ones and end with zero bytes or with the rest of the longer file.
std::size_t cut_behind_root(std::string& bytes) {
  constexpr std::string_view kEnd = "</COLLADA>";
  const std::size_t end = bytes.find(kEnd);
  if (end == std::string::npos) return 0;
  const std::string_view rest = std::string_view(bytes).substr(end + kEnd.size());
  const std::size_t start = rest.find_first_not_of(" \t\r\n");
  if (start == std::string_view::npos || rest.substr(start).starts_with("<!--")) return 0;
  const std::size_t behind = rest.size() - start;
  bytes.resize(bytes.size() - rest.size());
  return behind;
}

std::string hexadecimal(unsigned char byte) {
  constexpr char kDigits[] = "0123456789abcdef";
  return {'0', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
}

}  // namespace

SourceText read_collada_text(AssimpFile& file) {
  std::string bytes = read_bytes(file);
  const std::string name = file.file.string();
  if (const std::optional<Utf16> order = utf16_of(bytes)) bytes = utf8_of_utf16(bytes, *order);
  const std::size_t behind = cut_behind_root(bytes);
  if (bytes.starts_with(kUtf8Mark)) bytes.erase(0, kUtf8Mark.size());
  if (declares_windows_1252(bytes) && utf8_of_bytes(bytes).bytes > 0) bytes = utf8_of_windows_1252(bytes);
  Repaired repaired = utf8_of_bytes(bytes);
  SourceText text(std::move(repaired.text), name);
  if (repaired.bytes > 0) {
    const auto first = static_cast<unsigned char>(bytes[repaired.first]);
    file.warn_at(text.at(repaired.first), "byte " + hexadecimal(first) + " and " + std::to_string(repaired.bytes - 1) +
                                              " more are no characters of UTF-8 text; they are read as Windows-1252");
  }
  if (behind > 0) {
    file.warn_at(text.at(text.text().size()), std::to_string(behind) + " bytes behind </COLLADA> are left out");
  }
  return text;
}

}  // namespace simvis
