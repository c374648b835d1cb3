// Text that somebody wrote, and where in it things stand.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/location.h>

namespace simvis {

/// UTF-8 text with lines that end in LF, CR LF or CR.
class SourceText {
 public:
  /// A byte order mark is taken off. Throws InputError with the place of the first byte that is not UTF-8 text: a
  /// broken sequence, or a control character other than tab and line ends.
  SourceText(std::string_view text, std::string file);

  /// Throws InputError with the operating system's reason if the file cannot be read.
  static SourceText read(const std::filesystem::path& file);

  const std::string& text() const { return text_; }
  const std::string& file() const { return file_; }
  /// The place of the byte at `offset`; the end of the text for anything beyond it.
  Location at(std::size_t offset) const;

 private:
  std::string text_, file_;
  std::vector<std::size_t> line_starts_;
};

}  // namespace simvis
