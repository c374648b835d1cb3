// Where in a scene something was written, for error messages.
#pragma once

#include <string>
#include <string_view>

#include <simvis/error.h>

namespace simvis {

/// A place in a file. `line` and `column` count from 1, columns in bytes; 0 = not known.
struct Location {
  std::string file;
  int line = 0, column = 0;
};

/// "FILE:LINE:COLUMN", or as much of it as is known.
std::string to_string(const Location& where);

/// Throws InputError "FILE:LINE:COLUMN: error: MESSAGE".
[[noreturn]] void fail_at(const Location& where, std::string_view message);

/// The user's text in quotes for a message: on one line, control characters escaped, what is very long cut.
std::string in_quotes(std::string_view text);

}  // namespace simvis
