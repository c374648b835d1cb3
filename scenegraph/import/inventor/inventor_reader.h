// Reads a file with Coin. To be called in a process of its own: Coin may crash or hang on what is broken.
#pragma once

#include <filesystem>
#include <string>

#include "scenegraph/import/inventor/foreign_scene.h"
#include "scenegraph/import/inventor/guarded_child.h"

namespace simvis {

/// What a line of the child's log begins with.
inline constexpr char kInventorError = 'E', kInventorWarning = 'W';

/// Logs Coin's errors and warnings. Throws InputError where Coin refuses the file; the log says why.
ForeignScene read_with_coin(const std::filesystem::path& file, ChildLog& log);

}  // namespace simvis
