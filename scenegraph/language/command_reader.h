// Reads scene files: commands, and the statements `set`, `repeat` and `include` that produce commands.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/command.h>
#include "scenegraph/language/expression.h"
#include "scenegraph/language/source_text.h"

namespace simvis {

/// An XML text with commands.
struct SceneSource {
  SourceText text;
  std::filesystem::path folder;  ///< relative file names start here
  pugi::xml_document document;

  /// Throws InputError with the place if the text is malformed XML.
  SceneSource(SourceText source, std::filesystem::path from);
};

/// Reads one scene with all the files that it includes.
class CommandReader {
 public:
  /// Names of sensors that a part carries may have '/' between their words.
  explicit CommandReader(bool is_carried = false, FileCheck check_include = {})
      : is_carried_(is_carried), check_include_(std::move(check_include)) {}

  /// Throws InputError with the place. `file` is empty for a text that is not from a file.
  std::vector<Command> read(SourceText source, const std::filesystem::path& file, const std::filesystem::path& folder);

 private:
  // What surrounds a statement.
  struct Block {
    const SceneSource& source;
    VariableValues& variables;  // of the file
    std::shared_ptr<const IncludeScope> scope;
    bool repeated = false;
    std::vector<std::string> own{};  // variables that end with the block
  };
  void read_document(const SceneSource& source, std::shared_ptr<const IncludeScope> scope);
  void read_children(const pugi::xml_node& parent, Block& block);
  void read_statement(const pugi::xml_node& node, Block& block);
  void read_set(const Command& set, Block& block);
  void read_repeat(const pugi::xml_node& node, const Command& repeat, const Block& block);
  static void define(const CommandAttribute& name, double value, Block& block);
  void read_include(const Command& include, const Block& block);
  const SceneSource& included(const std::filesystem::path& file, const Location& where);
  void count_step(const pugi::xml_node& node, const Block& block);

  bool is_carried_;
  FileCheck check_include_;
  std::vector<Command> commands_;
  std::vector<std::filesystem::path> open_;  // files that are being read, each included by the one before
  std::map<std::pair<std::filesystem::path, std::string>, std::unique_ptr<SceneSource>> included_;  // by place too
  std::size_t included_bytes_ = 0, steps_ = 0, repetitions_ = 0;
};

/// Reads the commands that a part carries: as parse_commands(), but names of sensors may be LINK/NAME.
std::vector<Command> parse_carried_commands(std::string_view xml, const std::string& file,
                                            const std::filesystem::path& folder);

}  // namespace simvis
