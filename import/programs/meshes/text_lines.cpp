#include "import/programs/meshes/text_lines.h"

#include <algorithm>
#include <cstdint>

#include <simvis/location.h>
#include "engine/base/words.h"
#include "import/programs/utf16_text.h"

namespace simvis {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{4} << 20;
constexpr std::string_view kLineBlanks = " \t\v\f";

std::string_view without_blanks(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kLineBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kLineBlanks) + 1);
}

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

}  // namespace

std::string_view take_word(std::string_view& line) {
  const auto end = static_cast<std::size_t>(std::ranges::find_if(line, is_space) - line.begin());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(
      static_cast<std::size_t>(std::find_if_not(line.begin() + end, line.end(), is_space) - line.begin()));
  return word;
}

std::string shown_word(std::string_view word) {
  constexpr std::size_t kMaxBytes = 40;
  return in_quotes(word.substr(0, kMaxBytes));
}

std::string no_number(std::string_view subject, std::string_view word) {
  return std::string(subject) + " has " + shown_word(word) + " in place of a number";
}

TextLines::TextLines(PartSource& source, const std::filesystem::path& file) : name_(file.string()), file_(file) {
  read_more();
  if (utf16_of(text_)) convert(source);
  if (text_.starts_with(kUtf8Mark)) at_ = kUtf8Mark.size();
  find_ends();
}

void TextLines::convert(PartSource& source) {
  while (read_more()) {
  }
  text_ = utf8_of_utf16(text_, *utf16_of(text_));
  source.warn_at({.file = name_}, "is text in UTF-16, which few programs read");
}

// Blocks double, so that the time for one long line grows with its length alone.
bool TextLines::read_more() {
  text_.erase(0, at_);
  at_ = 0;
  const std::size_t kept = text_.size();
  text_.resize(kept + std::max(kBlockBytes, kept));
  const std::size_t got =
      file_.read_into({reinterpret_cast<std::uint8_t*>(text_.data()) + kept, text_.size() - kept}, read_);
  read_ += got;
  text_.resize(kept + got);
  find_ends();
  return got > 0;
}

void TextLines::find_ends() {
  lf_ = text_.find('\n', at_);
  cr_ = text_.find('\r', at_);
}

// None where the text so far does not say it: behind a CR, an LF may come.
std::size_t TextLines::end_of_line() {
  if (lf_ < at_) lf_ = text_.find('\n', at_);
  if (cr_ < at_) cr_ = text_.find('\r', at_);
  const std::size_t end = std::min(lf_, cr_);
  return end == cr_ && end + 1 == text_.size() ? text_.npos : end;
}

bool TextLines::next_single(std::string_view& line) {
  std::size_t end = end_of_line();
  while (end == text_.npos && read_more()) end = end_of_line();
  if (at_ == text_.size()) return false;
  ++line_;
  end = std::min({end, lf_, cr_, text_.size()});
  line = without_blanks(std::string_view(text_).substr(at_, end - at_));
  at_ = std::min(end + (std::string_view(text_).substr(end).starts_with("\r\n") ? 2 : 1), text_.size());
  return true;
}

std::optional<std::string_view> TextLines::next() {
  std::string_view line;
  if (!next_single(line)) return std::nullopt;
  first_line_ = line_;
  if (!line.ends_with('\\') || line.starts_with('#')) return line;
  joined_.clear();
  while (line.ends_with('\\')) {
    joined_.append(line.substr(0, line.size() - 1)).append(" ");
    if (!next_single(line)) return without_blanks(joined_);
  }
  joined_.append(line);
  return without_blanks(joined_);
}

}  // namespace simvis
