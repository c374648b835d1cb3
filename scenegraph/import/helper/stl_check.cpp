#include "scenegraph/import/helper/stl_check.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include <simvis/location.h>

namespace simvis {
namespace {

constexpr std::uint64_t kHeaderBytes = 84, kFacetBytes = 50;
constexpr std::string_view kSpaces = " \t\r\n";

std::string read_range(std::ifstream& stream, std::uint64_t from, std::uint64_t bytes) {
  std::string text(bytes, '\0');
  stream.clear();
  stream.seekg(static_cast<std::streamoff>(from));
  stream.read(text.data(), static_cast<std::streamsize>(bytes));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

// Returns whether the last line that is not empty begins with "endsolid".
bool ends_with_endsolid(std::string_view end) {
  const std::size_t last = end.find_last_not_of(kSpaces);
  if (last == std::string_view::npos) return false;
  end = end.substr(0, last + 1);
  const std::size_t line = end.find_last_of("\r\n");
  if (line != std::string_view::npos) end.remove_prefix(line + 1);
  const std::size_t start = end.find_first_not_of(kSpaces);
  return start != std::string_view::npos && end.substr(start).starts_with("endsolid");
}

}  // namespace

void check_stl(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const Location where{.file = file.string()};
  if (!stream) fail_at(where, "cannot be read");
  const auto size = static_cast<std::uint64_t>(stream.tellg());
  const std::string start = read_range(stream, 0, std::min(size, kHeaderBytes));
  std::uint64_t facets = 0;
  if (start.size() == kHeaderBytes) {
    for (std::size_t i = 0; i < 4; ++i) facets |= std::uint64_t{static_cast<unsigned char>(start[80 + i])} << (8 * i);
    if (size == kHeaderBytes + kFacetBytes * facets) {
      if (facets == 0) fail_at(where, "holds nothing to draw");
      return;
    }
  }
  const std::size_t word = start.find_first_not_of(kSpaces);
  if (word == std::string::npos || !std::string_view(start).substr(word).starts_with("solid")) {
    fail_at(where, "has " + std::to_string(size) + " bytes and claims " + std::to_string(facets) +
                       " facets, expected binary STL of 84 bytes and 50 per facet, or text that begins with \"solid\"");
  }
  constexpr std::uint64_t kLongestEnd = 4096;
  const std::uint64_t end_bytes = std::min(size, kLongestEnd);
  if (!ends_with_endsolid(read_range(stream, size - end_bytes, end_bytes))) {
    fail_at(where, "begins with \"solid\" but does not end with \"endsolid\": it is incomplete, or is not STL");
  }
}

}  // namespace simvis
