// The commands that part files carry.
#include <algorithm>

#include "engine/base/read_fence.h"
#include "scenegraph/language/command_reader.h"
#include "simvis/command_names.h"
#include "simvis/declared_sensors.h"
#include "simvis/scene_builder.h"

namespace simvis {
namespace {

// Limit of the nesting depth of parts; a greater depth is taken for an error.
constexpr std::size_t kMaxNested = 64;

}  // namespace

void SceneBuilder::run_carried(const Command& part, const PartContent& content, const std::string& prefix) {
  open_.push_back(content.file);
  const bool repeats = std::ranges::count(open_, content.file) > 1;
  if (repeats || open_.size() > kMaxNested) {
    std::string chain;
    for (const std::filesystem::path& file : open_) chain += (chain.empty() ? "" : " > ") + file.filename().string();
    fail_at(part.where,
            "part file " + in_quotes(content.file.string()) +
                (repeats ? " inserts itself: "
                         : " is nested deeper than " + std::to_string(kMaxNested) + " files, which is not allowed: ") +
                chain);
  }
  std::vector<Command> commands = carried_commands(part, content);
  if (!prefix.empty()) prefix_names(commands, content, prefix);
  const auto is_point = [this](const std::string& name) { return built_.scene.has_insertion_point(name); };
  adapt_declared_sensors(commands, content, {announced_sensors_, built_.sensors, is_point},
                         [this](const std::string& warning) { built_.scene.warn(warning); });
  try {
    run(commands);
  } catch (const InputError& error) {
    rethrow_from_part(part, error);
  }
  open_.pop_back();
}

std::vector<Command> SceneBuilder::carried_commands(const Command& part, const PartContent& content) const {
  std::vector<Command> commands;
  if (content.commands.empty()) return commands;
  Folders folders = folders_of_part(content.file);
  for (const PackageFolder& package : built_.scene.packages()) folders.push_back(package.folder);
  const ReadFence fence(folders);
  try {
    for (std::size_t i = 0; i < content.commands.size(); ++i) {
      const std::string file = content.file.string() + "(command " + std::to_string(i + 1) + ")";
      const std::vector<Command> parsed = parse_carried_commands(content.commands[i], file, content.file.parent_path());
      commands.insert(commands.end(), parsed.begin(), parsed.end());
    }
  } catch (const InputError& error) {
    rethrow_from_part(part, error);
  }
  for (Command& command : commands) {
    if (command.kind == CommandKind::remove) fail_at(command.where, "a part file cannot remove anything");
    for (const CommandAttribute& attribute : command.attributes) {
      if (!refers_to_file(command, attribute) || is_readable(command.folder / attribute.value)) continue;
      fail_at(attribute.where, in_quotes(attribute.value) + " lies outside the folders of the part file that names it");
    }
    if (command.find("insert_at") == nullptr) {
      command.attributes.push_back({"insert_at", part.require("name").value, command.where});
    }
  }
  return commands;
}

}  // namespace simvis
