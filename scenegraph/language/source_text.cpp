#include "scenegraph/language/source_text.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>

#include "engine/base/input_file.h"
#include "engine/base/input_log.h"
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"

namespace simvis {
namespace {

unsigned char byte_at(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0;
}

// A device may never end: no text holds a zero byte, and none is so long.
constexpr std::size_t kMaxBytes = std::size_t{1} << 30;

// Appends what can be read of a file that the user names, a pipe or a device too, up to the block with the first zero
// byte. Returns the number of the error, or 0.
int read_text(const std::filesystem::path& file, std::string& text) {
  struct Open {
    int descriptor;
    ~Open() { ::close(descriptor); }
  };
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const Open open{descriptor};
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  while (text.size() <= kMaxBytes) {
    const std::size_t before = text.size();
    text.resize(before + kBlock);
    const ssize_t got = ::read(descriptor, text.data() + before, kBlock);
    text.resize(before + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return errno;
    if (got == 0 || text.find('\0', before) != std::string::npos) break;
  }
  return 0;
}

// The same, of a file that a part or a request names.
std::string read_input_text(const std::filesystem::path& file) {
  const InputFile input(file);
  const Bytes bytes = input.read(0, std::min(input.size(), kMaxBytes + 1));
  return {bytes.begin(), bytes.end()};
}

}  // namespace

std::size_t text_character_length(std::string_view text, std::size_t i) {
  const unsigned char first = byte_at(text, i);
  if (first < 0x80) return first >= 0x20 || first == '\t' || first == '\n' || first == '\r' ? 1 : 0;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4) return 0;
  std::uint32_t code = first & (0xff >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) {
    const unsigned char next = byte_at(text, i + k);
    if ((next & 0xc0) != 0x80) return 0;
    code = code << 6 | (next & 0x3f);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return overlong || surrogate || code > 0x10ffff ? 0 : length;
}

SourceText::SourceText(std::string_view text, std::string file, const std::string& included_from)
    : file_(std::move(file)),
      included_from_(included_from.empty() ? nullptr : std::make_shared<const std::string>(included_from)),
      line_starts_{0} {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  text_ = text;
  std::size_t i = 0;
  while (i < text.size()) {
    const std::size_t length = text_character_length(text, i);
    if (length == 0) {
      static constexpr char kDigits[] = "0123456789abcdef";
      const unsigned char byte = byte_at(text, i);
      fail_at(at(i), std::string("byte 0x") + kDigits[byte >> 4] + kDigits[byte & 15] +
                         " is not allowed in UTF-8 text, expected a file of UTF-8 text");
    }
    const bool line_end = text[i] == '\n' || (text[i] == '\r' && byte_at(text, i + 1) != '\n');
    i += length;
    if (line_end) line_starts_.push_back(i);
  }
}

SourceText SourceText::read(const std::filesystem::path& file, const std::string& included_from) {
  if (file.native().find('\0') == std::string::npos && is_input_folder(file)) {
    fail_at({.file = file.string()}, "cannot be read: it is a folder");
  }
  require_readable(file);
  std::string text;
  if (read_scope()) {
    text = read_input_text(file);
  } else if (const int error = read_text(file, text)) {
    throw_read_error(file, "cannot be read", error);
  }
  if (text.size() > kMaxBytes) fail_at({.file = file.string()}, "has more than 1 GiB, expected a file of text");
  note_input(file);
  refuse_lfs_pointer(file, text);
  return SourceText(text, file.string(), included_from);
}

Location SourceText::at(std::string_view part) const {
  return at(static_cast<std::size_t>(part.data() - text_.data()));
}

Location SourceText::at(std::size_t offset) const {
  offset = std::min(offset, text_.size());
  const auto line = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset) - 1;
  return {.file = file_,
          .line = static_cast<int>(line - line_starts_.begin()) + 1,
          .column = static_cast<int>(offset - *line) + 1,
          .included_from = included_from_};
}

}  // namespace simvis
