#include "import/programs/stl_check.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include <simvis/location.h>
#include "engine/base/input_file.h"

namespace simvis {
namespace {

constexpr std::uint64_t kHeaderBytes = 84, kFacetBytes = 50;
constexpr std::string_view kStlSpaces = " \t\r\n";

std::string read_range(const InputFile& file, std::uint64_t from, std::uint64_t bytes) {
  const Bytes range = file.read(from, bytes);
  return {range.begin(), range.end()};
}

// Returns whether the last line that is not empty begins with "endsolid".
bool ends_with_endsolid(std::string_view end) {
  const std::size_t last = end.find_last_not_of(kStlSpaces);
  if (last == std::string_view::npos) return false;
  end = end.substr(0, last + 1);
  const std::size_t line = end.find_last_of("\r\n");
  if (line != std::string_view::npos) end.remove_prefix(line + 1);
  const std::size_t start = end.find_first_not_of(kStlSpaces);
  return start != std::string_view::npos && end.substr(start).starts_with("endsolid");
}

// The two bytes behind a facet hold a colour of 15 bits if the 16th is set (VisCAM, SolidView). Returns whether facets
// are marked so and all of these colours are 0. Files of Magics, whose header has "COLOR=", mean something else.
bool has_marks_without_colors(const InputFile& file, std::string_view header, std::uint64_t facets) {
  if (header.find("COLOR=") != std::string_view::npos) return false;
  constexpr std::size_t kAttributeAt = 48;
  constexpr std::uint64_t kBlock = 1 << 14;  // facets that are read at once
  bool is_marked = false;
  for (std::uint64_t first = 0; first < facets; first += kBlock) {
    const std::uint64_t count = std::min(kBlock, facets - first);
    const std::string block = read_range(file, kHeaderBytes + first * kFacetBytes, count * kFacetBytes);
    for (std::size_t at = kAttributeAt; at + 1 < block.size(); at += kFacetBytes) {
      const auto low = static_cast<unsigned char>(block[at]), high = static_cast<unsigned char>(block[at + 1]);
      if ((high & 0x80) == 0) continue;
      if (low != 0 || high != 0x80) return false;
      is_marked = true;
    }
  }
  return is_marked;
}

// What Assimp takes for the beginning of a number.
bool begins_number(std::string_view word) {
  const std::size_t sign = !word.empty() && (word[0] == '-' || word[0] == '+') ? 1 : 0;
  word.remove_prefix(sign);
  if (word.starts_with('.')) word.remove_prefix(1);
  const auto is = [&](std::string_view start) { return word.starts_with(start); };
  return (!word.empty() && word[0] >= '0' && word[0] <= '9') || is("nan") || is("NaN") || is("NAN") || is("inf") ||
         is("INF");
}

// The words of a text with their lines.
class StlWords {
 public:
  explicit StlWords(std::string_view text) : text_(text) {}
  int line() const { return line_; }
  std::string_view next() {
    while (at_ < text_.size() && kStlSpaces.find(text_[at_]) != std::string_view::npos) line_ += text_[at_++] == '\n';
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(kStlSpaces, at_), text_.size());
    return text_.substr(begin, at_ - begin);
  }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

// Assimp names no line, and repeats the rest of the file.
void check_text(const std::string& text, const Location& where) {
  constexpr int kShownBytes = 40;
  StlWords words(text);
  int corners = 0, facet_line = 0;
  const auto fail = [&](int line, const std::string& what) { fail_at({.file = where.file, .line = line}, what); };
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word == "facet") {
      corners = 0;
      facet_line = words.line();
    }
    if (word == "endfacet" && corners < 3) {
      fail(facet_line, "a facet has " + std::to_string(corners) + " vertices, expected 3");
    }
    const bool is_vertex = word == "vertex";
    if (!is_vertex && word != "normal") continue;
    corners += is_vertex;
    for (int i = 0; i < 3; ++i) {
      const std::string_view number = words.next();
      if (begins_number(number)) continue;
      fail(words.line(), std::string(is_vertex ? "a vertex" : "a normal") + " has " +
                             in_quotes(number.substr(0, kShownBytes)) + " in place of a number");
    }
  }
}

}  // namespace

bool check_stl(AssimpFile& file) {
  const InputFile input(file.file);
  const Location where{.file = file.file.string()};
  const std::uint64_t size = input.size();
  const std::string start = read_range(input, 0, std::min(size, kHeaderBytes));
  std::uint64_t facets = 0;
  if (start.size() == kHeaderBytes) {
    for (std::size_t i = 0; i < 4; ++i) facets |= std::uint64_t{static_cast<unsigned char>(start[80 + i])} << (8 * i);
    if (size == kHeaderBytes + kFacetBytes * facets) {
      if (facets == 0) fail_at(where, "holds nothing to draw");
      return has_marks_without_colors(input, start, facets);
    }
  }
  const std::size_t word = start.find_first_not_of(kStlSpaces);
  if (word == std::string::npos || !std::string_view(start).substr(word).starts_with("solid")) {
    fail_at(where, "has " + std::to_string(size) + " bytes and claims " + std::to_string(facets) +
                       " facets, expected binary STL of 84 bytes and 50 per facet, or text that begins with \"solid\"");
  }
  constexpr std::uint64_t kLongestEnd = 4096;
  const std::uint64_t end_bytes = std::min(size, kLongestEnd);
  if (!ends_with_endsolid(read_range(input, size - end_bytes, end_bytes))) {
    fail_at(where, "begins with \"solid\" but does not end with \"endsolid\": it is incomplete, or is not STL");
  }
  check_text(read_range(input, 0, size), where);
  return false;
}

}  // namespace simvis
