// A source text and the line and column of each byte in it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/location.h>

namespace simvis {

/// Returns the length in bytes of the text character that starts at `i`, or 0 if there is none: a broken UTF-8
/// sequence, or a control character other than tabs and line ends. `i` is within the text.
std::size_t text_character_length(std::string_view text, std::size_t i);

/// UTF-8 text with lines that end in LF, CR LF or CR.
class SourceText {
 public:
  /// Removes a byte order mark. Throws InputError with the place of the first byte that is not UTF-8 text: a broken
  /// sequence, or a control character other than tabs and line ends.
  /// `included_from` becomes part of every place; empty: the text is not included.
  SourceText(std::string_view text, std::string file, const std::string& included_from = {});

  /// Throws InputError with the operating system's reason if the file cannot be read, or has more than 1 GiB, as a
  /// device that never ends; MachineError if the machine fails (read_error.h).
  static SourceText read(const std::filesystem::path& file, const std::string& included_from = {});

  const std::string& text() const { return text_; }
  const std::string& file() const { return file_; }
  /// Returns the place of the byte at `offset`. An offset beyond the text gives the end of the text.
  Location at(std::size_t offset) const;
  /// Returns the place of a part of text(), as words.h cuts them out.
  Location at(std::string_view part) const;

 private:
  std::string text_, file_;
  std::shared_ptr<const std::string> included_from_;
  std::vector<std::size_t> line_starts_;
};

}  // namespace simvis
