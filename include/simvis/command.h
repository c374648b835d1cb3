// The three commands of the scene language, read from XML: part, element, sensor.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/location.h>

namespace simvis {

enum class CommandKind : std::uint8_t { part, element, sensor };

struct CommandAttribute {
  std::string name, value;
  Location where;  ///< of the attribute's name
};

/// One command as written: nothing is interpreted yet but the kind.
struct Command {
  CommandKind kind = CommandKind::part;
  std::vector<CommandAttribute> attributes;  ///< in the order written, names unique
  Location where;                            ///< of the tag's name
  std::filesystem::path folder;              ///< relative file names in the command start here

  const CommandAttribute* find(std::string_view name) const;
  /// Throws InputError at the command when the attribute was not written.
  const CommandAttribute& require(std::string_view name) const;
};

/// "part", "element", "sensor"
std::string_view to_string(CommandKind kind);

/// The command as it could stand in a scene file: what the change log keeps.
std::string to_string(const Command& command);

/// Reads commands, with or without one enclosing root element. Comments, declarations and processing instructions are
/// passed over. No command at all is an empty scene.
///
/// Names    a name is not empty, not all spaces, and has no control characters. Names of elements and sensors have no
///          '.' either, which would clash with ELEMENT.PARAM, and no '/', which would clash with folders of results.
/// Root     any name but a command's; it has no attributes.
/// Errors   `file` names the text in messages. Throws InputError with the place: not UTF-8 text, malformed XML, an
///          unknown command (the nearest known one suggested), an attribute given twice, a name that breaks the rule,
///          text between commands, children of a command.
std::vector<Command> parse_commands(std::string_view xml, const std::string& file, const std::filesystem::path& folder);

/// Reads a scene file. Throws InputError if it cannot be read.
std::vector<Command> read_commands(const std::filesystem::path& file);

}  // namespace simvis
