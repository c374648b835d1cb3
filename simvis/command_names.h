// Names in commands: what an attribute refers to, files among it, and the prefix of names in included files and in
// parts.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/command.h>
#include <simvis/scene.h>
#include "engine/base/program_api.h"

namespace simvis {

/// The attributes of a command that name something of the scene, with their kinds in the table of its type: part,
/// object, objects, element or sensor.
std::map<std::string, AttributeKind, std::less<>> reference_kinds(const Command& command);

/// What an attribute of such a kind names one of; empty: it names several, by patterns.
std::optional<CommandKind> referred_kind(AttributeKind kind);

/// The words of a value of kind AttributeKind::objects with the prefix of `prefix_of`, which says it for each word, or
/// returns an empty text.
std::string with_prefixes(const std::string& value, const std::function<std::string(const std::string&)>& prefix_of);

/// Whether the attribute names a file, by the table of the command's type. False for attributes that no table has: they
/// are refused before a file is opened.
SIMVIS_PROGRAM_API bool refers_to_file(const Command& command, const CommandAttribute& attribute);

/// The prefix of the included file that has the command.
std::string prefix_of(const Command& command);

/// Adds the prefix to the names that a part file defines, and to its references to them.
void prefix_names(std::vector<Command>& commands, const PartContent& content, const std::string& prefix);

}  // namespace simvis
