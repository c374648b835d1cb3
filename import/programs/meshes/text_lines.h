// The lines of a text file, which is read block by block, and their words.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "engine/base/input_file.h"
#include "import/programs/part_source.h"

namespace simvis {

/// Removes the first word from `line`, which has no white space before it, and that behind the word; returns the word,
/// which is empty if there is none.
std::string_view take_word(std::string_view& line);

/// A word of a file in a message: in quotes, and cut if it is long.
std::string shown_word(std::string_view word);

/// "SUBJECT has "WORD" in place of a number".
std::string no_number(std::string_view subject, std::string_view word);

class TextLines {
 public:
  /// Throws like InputFile. UTF-16 is converted, with a warning; a byte order mark is left out.
  TextLines(PartSource& source, const std::filesystem::path& file);

  /// The next line without blanks at its ends; empty: there is none. A line that ends with a backslash and
  /// is no comment (#) goes on in the next one. Lines end with LF, CR LF or CR. Valid until the next call.
  std::optional<std::string_view> next();

  /// Where the line of the last next() begins.
  Location where() const { return place(first_line_); }
  int line() const { return first_line_; }
  Location place(int line) const { return {.file = name_, .line = line}; }

 private:
  bool next_single(std::string_view& line);
  std::size_t end_of_line();
  bool read_more();
  void find_ends();
  void convert(PartSource& source);

  std::string name_;
  InputFile file_;
  std::string text_, joined_;      // bytes of the file that are not used up; a line with those that it goes on in
  std::size_t read_ = 0, at_ = 0;  // bytes of the file in text_ so far; the next line in text_
  std::size_t lf_ = text_.npos, cr_ = lf_;  // the next one of each in text_ from at_ on
  int line_ = 0, first_line_ = 0;
};

}  // namespace simvis
