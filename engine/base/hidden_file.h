// Temporary files that become visible when they are renamed, and what killed programs leave of them.
#pragma once

#include <filesystem>

#include "engine/base/program_api.h"

namespace simvis {

/// The temporary name of a file: hidden, in the same folder, and different at each call.
SIMVIS_PROGRAM_API std::filesystem::path hidden_name(const std::filesystem::path& path);

/// Removes files with names of hidden_name() from the folder, but not from folders in it. Those of processes of this
/// machine that run stay: they may be of files that another run writes there. If `own_only`, those of other machines
/// stay too. Errors are ignored.
SIMVIS_PROGRAM_API void remove_leftovers(const std::filesystem::path& folder, bool own_only);

/// Removes the temporary files of this file alone that processes of this machine left, which have ended. Reads the
/// whole folder: for files that a user names, not for each picture of a run. Errors are ignored.
SIMVIS_PROGRAM_API void remove_leftovers_of(const std::filesystem::path& path);

}  // namespace simvis
