// Words, cells and lines of a text, and the numbers that they stand for. Nothing here depends on the locale.
//
// Lifetime  The views that the functions return look into the text that they were given.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace simvis {

inline constexpr std::string_view kBlanks = " \t\r\n";

/// Returns the text without blanks at its ends.
inline std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

/// Returns the words that separators separate. No word is empty.
inline std::vector<std::string_view> words_of(std::string_view text, std::string_view separators = kBlanks) {
  std::vector<std::string_view> words;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(separators), text.size()));
    if (text.empty()) return words;
    words.push_back(text.substr(0, text.find_first_of(separators)));
    text.remove_prefix(words.back().size());
  }
}

/// Returns the cells between single separators, each without blanks at its ends. There is one cell more than there are
/// separators; cells may be empty.
inline std::vector<std::string_view> cells_of(std::string_view text, char separator = ',') {
  std::vector<std::string_view> cells;
  while (true) {
    const std::size_t end = text.find(separator);
    cells.push_back(trimmed(text.substr(0, end)));
    if (end == text.npos) return cells;
    text.remove_prefix(end + 1);
  }
}

/// Returns the line that begins at `at`, without its end (LF, CR LF or CR), and moves `at` behind that end. `at` must
/// be below the size of the text.
inline std::string_view next_line(std::string_view text, std::size_t& at) {
  const std::size_t first = at, end = std::min(text.find_first_of("\r\n", first), text.size());
  at = std::min(end + (text.substr(end).starts_with("\r\n") ? 2 : 1), text.size());
  return text.substr(first, end - first);
}

/// Returns the next line that is neither blank nor a comment, which begins with #, and moves `at` as next_line() does.
/// Empty: there is none.
inline std::string_view next_row(std::string_view text, std::size_t& at) {
  while (at < text.size()) {
    const std::string_view line = next_line(text, at), content = trimmed(line);
    if (!content.empty() && !content.starts_with('#')) return line;
  }
  return {};
}

/// Returns the number that the whole word is by the rules of std::from_chars(); empty: it is none, or out of range.
template <typename Number, typename... Base>
std::optional<Number> as_number(std::string_view word, Base... base) {
  Number number{};
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, number, base...);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

}  // namespace simvis
