// Places in scene files, for error messages.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <simvis/error.h>

namespace simvis {

/// A place in a file.
struct Location {
  std::string file;  ///< name for messages; empty: not known
  int line = 0,      ///< counts from 1; 0: not known
      column = 0;    ///< counts from 1, in bytes; 0: not known
  /// The place that includes the file, as text; null: the file is not included.
  std::shared_ptr<const std::string> included_from{};
};

/// "FILE:LINE:COLUMN", or the part of it that is known.
std::string to_string(const Location& where);

/// Throws InputError "FILE:LINE:COLUMN: error: MESSAGE", with " (included from FILE:LINE:COLUMN)" if the file is.
[[noreturn]] void fail_at(const Location& where, std::string_view message);

/// The user's text in quotes for a message: on one line, control characters escaped, very long text cut.
std::string in_quotes(std::string_view text);

}  // namespace simvis
