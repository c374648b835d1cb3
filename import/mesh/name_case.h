// Finds files whose names differ in upper and lower case from what a part file says.
#pragma once

#include <filesystem>
#include <optional>

namespace simvis {

/// The file `name` below `folder`, where each component may differ in upper and lower case. Of several entries that do,
/// the first in the order of bytes counts. Empty: there is none.
std::optional<std::filesystem::path> file_ignoring_case(const std::filesystem::path& folder,
                                                        const std::filesystem::path& name);

}  // namespace simvis
