// Places in scene files, and texts for error messages.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <simvis/error.h>
#include <simvis/export.h>

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
SIMVIS_API std::string to_string(const Location& where);

/// Throws InputError "FILE:LINE:COLUMN: error: MESSAGE", with " (included from FILE:LINE:COLUMN)" if the file is.
[[noreturn]] SIMVIS_API void fail_at(const Location& where, std::string_view message);

/// The user's text in quotes for a message: on one line, quotes and control characters escaped, very long text cut.
SIMVIS_API std::string in_quotes(std::string_view text);

/// The known name that is most similar to `seen`, or an empty string if none is similar.
SIMVIS_API std::string nearest_name(std::string_view seen, std::span<const std::string_view> known);

/// ", did you mean \"NAME\"?" with nearest_name(), or an empty string if no name is similar.
SIMVIS_API std::string suggestion(std::string_view seen, std::span<const std::string_view> known);

}  // namespace simvis
