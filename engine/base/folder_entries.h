// The entries of a folder, with errors that say whose fault they are.
#pragma once

#include <filesystem>
#include <vector>

namespace simvis {

/// The paths of the entries, FOLDER/NAME, sorted. None if there is no such folder or it may not be read. Throws
/// MachineError if the machine fails, as when too many files are open (read_error.h).
std::vector<std::filesystem::path> folder_entries(const std::filesystem::path& folder);

}  // namespace simvis
