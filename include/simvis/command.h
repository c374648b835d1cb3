// The commands of the scene language (part, element, sensor, remove), read from XML. `include`, `set` and `repeat` are
// carried out while reading.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/export.h>
#include <simvis/location.h>

namespace simvis {

/// The tag of a command.
enum class CommandKind : std::uint8_t {
  part,     ///< inserts the content of a file
  element,  ///< makes an object that changes the scene
  sensor,   ///< makes a sensor
  remove    ///< takes out what an earlier command made
};

/// One attribute as written.
struct CommandAttribute {
  std::string name,  ///< as in XML
      value;         ///< as in XML, entities resolved
  Location where;    ///< of the attribute's name
};

/// The names in an included file. A name that the file defines gets the prefix. A name that it refers to is looked up
/// with the prefix, then as in the file around it.
struct IncludeScope {
  std::string prefix;                         ///< with the prefixes of the files around it
  std::optional<CommandAttribute> root;       ///< what ROOT means, a name of the file around it; empty: ROOT as there
  std::shared_ptr<const IncludeScope> outer;  ///< of the file around it; null: that file is not included
};

/// One command as written. Only its kind is interpreted.
struct SIMVIS_API Command {
  CommandKind kind = CommandKind::part;         ///< the tag
  std::vector<CommandAttribute> attributes;     ///< in the order written; names are unique
  Location where;                               ///< of the tag's name
  std::filesystem::path folder;                 ///< relative file names in the command start here
  std::shared_ptr<const IncludeScope> scope{};  ///< of the included file that has the command; null: none

  /// The attribute of this name, or null. The pointer is valid until `attributes` changes.
  const CommandAttribute* find(std::string_view name) const;
  /// The attribute of this name, which is valid until `attributes` changes. Throws InputError at the command if the
  /// attribute was not written.
  const CommandAttribute& require(std::string_view name) const;
};

/// "part", "element", "sensor" or "remove". The text is static.
SIMVIS_API std::string_view to_string(CommandKind kind);

/// The command in the form of a scene file. The change log keeps this text.
SIMVIS_API std::string to_string(const Command& command);

/// Reads commands, with or without one enclosing root element. Comments, declarations and processing instructions are
/// skipped. A text without commands is an empty scene.
///
/// Names    a name is not empty, does not consist of spaces alone, and has no control characters. Names of elements and
///          sensors have no '.', which is the separator of ELEMENT.PARAM, and no '/', which is the separator of result
///          folders.
/// Root     any name except a command's; it has no attributes.
/// Values   "${EXPRESSION}" in an attribute is replaced by its value. The statement `set` (name, value) defines a
///          variable to the end of the file or repetition, `repeat` (count, as) repeats its content with the variable
///          from 0 to count - 1, `include` (file) stands for the commands of a file, which does not see the variables
///          of this one.
/// Errors   InputError with the place; `file` names the text in messages: not UTF-8, malformed XML, an unknown command
///          (the nearest known one is suggested), an attribute given twice, a name that breaks the rule, text between
///          commands, children of a command, a wrong expression, a file that includes itself, too many repetitions.
/// Threads  any number at a time.
/// `check_include`, if given, is called with the attribute `file` of each `include` and the folder that its name is
/// relative to, before that file is looked for; it throws to refuse the file.
using FileCheck = std::function<void(const CommandAttribute& file, const std::filesystem::path& folder)>;
SIMVIS_API std::vector<Command> parse_commands(std::string_view xml, const std::string& file,
                                               const std::filesystem::path& folder,
                                               const FileCheck& check_include = {});

/// Reads a scene file. Relative file names in it start at its folder, those in an included file at the folder of that.
///
/// Errors   those of parse_commands(), and InputError if the file cannot be read.
SIMVIS_API std::vector<Command> read_commands(const std::filesystem::path& file);

}  // namespace simvis
