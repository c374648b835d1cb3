#include "import/programs/clouds/text_points.h"

#include <algorithm>
#include <limits>
#include <string>

#include <simvis/location.h>
#include <simvis/size_product.h>
#include "engine/base/words.h"

namespace simvis {
namespace {

constexpr std::string_view kBlank = " \t\r";

// The next word of a line from `at` on; empty at its end.
std::string_view next_word(std::string_view line, std::size_t& at) {
  const std::size_t first = std::min(line.find_first_not_of(kBlank, at), line.size());
  at = std::min(line.find_first_of(kBlank, first), line.size());
  return line.substr(first, at - first);
}

}  // namespace

std::string_view line_of(std::string_view text, std::size_t& at) {
  const std::size_t first = at, end = std::min(text.find('\n', at), text.size());
  at = std::min(end + 1, text.size());
  return text.substr(first, end - first);
}

std::vector<double> read_text_points(const std::filesystem::path& file, std::string_view text, std::size_t at, int line,
                                     std::size_t count, std::size_t columns) {
  // A number takes two bytes at least, so that a wrong count costs no memory.
  const std::size_t all = size_product({count, columns});
  if (count > text.size() / 2 || all > text.size()) {
    fail_at({.file = file.string()}, "ends too early: its header claims " + std::to_string(count) + " points");
  }
  std::vector<double> numbers;
  numbers.reserve(all);
  while (numbers.size() < all) {
    if (at >= text.size()) {
      fail_at({.file = file.string(), .line = line},
              "ends after " + std::to_string(numbers.size() / columns) + " points, expected " + std::to_string(count));
    }
    const std::string_view of_point = line_of(text, at);
    ++line;
    std::size_t in_line = 0, found = 0;
    for (; found < columns; ++found) {
      const std::string_view word = next_word(of_point, in_line);
      if (word.empty()) break;
      numbers.push_back(as_number<double>(word).value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    if (found != 0 && found != columns) {
      fail_at({.file = file.string(), .line = line},
              "a point with " + std::to_string(found) + " numbers, expected " + std::to_string(columns));
    }
  }
  return numbers;
}

PointColumn text_column(const std::vector<double>& numbers, std::size_t columns, std::size_t column) {
  return {.first = reinterpret_cast<const std::uint8_t*>(numbers.data() + column),
          .stride = columns * sizeof(double),
          .type = {.kind = NumberType::Kind::real, .bytes = sizeof(double)}};
}

}  // namespace simvis
