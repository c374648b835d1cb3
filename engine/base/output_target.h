// The one rule for files that a user names: what may be replaced, and where.
#pragma once

#include <filesystem>

#include "engine/base/program_api.h"

namespace simvis {

/// Where the bytes for a named file go.
struct OutputTarget {
  std::filesystem::path file;  ///< behind all symbolic links; it is a regular file or does not exist
  bool is_stream = false;      ///< `file` is a character device, such as /dev/null: write to it, do not replace it
};

/// Symbolic links are followed, so that the link stays and the file behind it is replaced. Folders, block devices,
/// FIFOs and sockets are refused: the open of a FIFO waits for a reader, possibly without end. So are links that
/// another user has put into a folder where all users may write, such as /tmp.
///
/// Errors   InputError that names the file and what it is.
SIMVIS_PROGRAM_API OutputTarget output_target(const std::filesystem::path& named);

/// As output_target(), for files that are not written from the beginning to the end: character devices are refused too.
SIMVIS_PROGRAM_API std::filesystem::path regular_target(const std::filesystem::path& named);

}  // namespace simvis
