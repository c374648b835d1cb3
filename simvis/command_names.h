// Names in commands: what an attribute refers to, and the prefix of names in included files and in parts.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/command.h>
#include <simvis/scene.h>

namespace simvis {

/// The kind of object that an attribute of a command refers to.
std::optional<CommandKind> referred_kind(const Command& command, std::string_view attribute);

/// The prefix of the included file that has the command.
std::string prefix_of(const Command& command);

/// Adds the prefix to the names that a part file defines, and to its references to them.
void prefix_names(std::vector<Command>& commands, const PartContent& content, const std::string& prefix);

}  // namespace simvis
