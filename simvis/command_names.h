// Names in commands: what an attribute refers to, files among it, and the prefix of names in included files and in
// parts.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include <simvis/scene.h>
#include "engine/base/program_api.h"

namespace simvis {

/// The kind of object that an attribute of a command refers to.
std::optional<CommandKind> referred_kind(const Command& command, std::string_view attribute);

/// Whether the attribute names a file, by the table of the command's type. False for attributes that no table has: they
/// are refused before a file is opened.
SIMVIS_PROGRAM_API bool refers_to_file(const Command& command, const CommandAttribute& attribute);

/// The prefix of the included file that has the command.
std::string prefix_of(const Command& command);

/// Adds the prefix to the names that a part file defines, and to its references to them.
void prefix_names(std::vector<Command>& commands, const PartContent& content, const std::string& prefix);

}  // namespace simvis
