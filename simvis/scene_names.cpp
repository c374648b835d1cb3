// The names that executed commands have taken, and those that the commands under way mean.
#include <algorithm>
#include <map>
#include <system_error>
#include <utility>

#include "simvis/command_names.h"
#include "simvis/declared_sensors.h"
#include "simvis/scene_builder.h"

namespace simvis {

// Finds the files that these commands insert several times. Insertions of one name are no copies: the second one fails.
void SceneBuilder::note_copies(std::span<const Command> commands) {
  std::map<Carrier, std::string> names;  // of the first insertion
  for (const Command& command : commands) {
    const CommandAttribute *const file = command.find("file"), *const name = command.find("name");
    if (command.kind != CommandKind::part || file == nullptr || name == nullptr) continue;
    std::error_code error;
    const Carrier carrier(prefix_of(command), std::filesystem::canonical(command.folder / file->value, error));
    const auto [first, is_first] = names.try_emplace(carrier, name->value);
    if (error || is_first || first->second == name->value || !copied_.insert(carrier).second) continue;
    built_.scene.undo().add_for_roll_back([this, carrier] { copied_.erase(carrier); });
  }
}

// Sensors may be referred to before their commands, and a sensor of a model's file gives way to one of the same name.
void SceneBuilder::announce(std::span<const Command> commands) {
  for (const Command& command : commands) {
    const CommandAttribute* const name = command.find("name");
    if (command.kind != CommandKind::sensor || name == nullptr) continue;
    announced_sensors_.insert(prefix_of(command) + name->value);
  }
}

// Gives the names in a command of an included file the prefix that they have in the whole scene, and replaces paths of
// objects by their names.
Command SceneBuilder::named(Command command) const {
  const std::map<std::string, AttributeKind, std::less<>> kinds = reference_kinds(command);
  const IncludeScope* const scope = command.scope.get();
  for (CommandAttribute& attribute : command.attributes) {
    const auto found = kinds.find(attribute.name);
    if (attribute.name == "name") {
      attribute.value = prefix_of(command) + attribute.value;
    } else if (found == kinds.end()) {
      continue;
    } else if (const std::optional<CommandKind> kind = referred_kind(found->second)) {
      resolve(*kind, attribute, scope);
    } else {
      attribute.value =
          with_prefixes(attribute.value, [&](const std::string& pattern) { return prefix_of_pattern(pattern, scope); });
    }
  }
  return command;
}

// The prefix of the innermost included file that has an object which matches.
std::string SceneBuilder::prefix_of_pattern(const std::string& pattern, const IncludeScope* scope) const {
  for (; scope != nullptr; scope = scope->outer.get()) {
    if (!scope->prefix.empty() && !built_.scene.objects().matching(scope->prefix + pattern).empty())
      return scope->prefix;
  }
  return "";
}

void SceneBuilder::resolve(CommandKind kind, CommandAttribute& reference, const IncludeScope* scope) const {
  for (; scope != nullptr; scope = scope->outer.get()) {
    if (kind == CommandKind::part && reference.value == built_.scene.root()->name) {
      if (scope->root) reference = {reference.name, scope->root->value, scope->root->where};
    } else if (exists(kind, scope->prefix + reference.value)) {
      reference.value = scope->prefix + reference.value;
      return;
    }
  }
  if (kind != CommandKind::part) return;
  const ObjectTree& tree = built_.scene.objects();
  if (const std::optional<std::uint32_t> found = tree.find(reference.value)) reference.value = tree[*found].name;
}

bool SceneBuilder::exists(CommandKind kind, const std::string& name) const {
  switch (kind) {
    case CommandKind::part:
      return built_.scene.has_insertion_point(name);
    case CommandKind::element:
      return element_names_.contains(name);
    case CommandKind::sensor:
      return sensor_names_.contains(name) || announced_sensors_.contains(name);
    case CommandKind::remove:
      break;
  }
  return false;
}

void SceneBuilder::note_carrier(const Carrier& carrier) {
  carriers_.insert(carrier);
  built_.scene.undo().add([this, carrier] { carriers_.erase(carriers_.find(carrier)); },
                          [this, carrier] { carriers_.insert(carrier); });
}

// Whether the names within a part need a prefix: the part is several times in the scene or in the commands under way,
// or one of its names is taken, if only by the part itself.
bool SceneBuilder::clashes(std::span<const Command> carried, const PartContent& content, const std::string& prefix,
                           const std::string& part_name) const {
  const Carrier copy(prefix, content.file);
  if (carriers_.contains(copy) || copied_.contains(copy)) return true;
  const auto point_taken = [&](const std::string& name) {
    return prefix + name == part_name || built_.scene.has_insertion_point(prefix + name);
  };
  if (std::ranges::any_of(content.points, point_taken)) return true;
  return std::ranges::any_of(carried, [&](const Command& command) {
    const CommandAttribute* const name = command.find("name");
    if (name == nullptr) return false;
    switch (command.kind) {
      case CommandKind::part:
        return point_taken(name->value);
      case CommandKind::element:
        return element_names_.contains(prefix + name->value);
      case CommandKind::sensor:
        return sensor_names_.contains(prefix + name->value) &&
               !(is_declared(command, content) && announced_sensors_.contains(prefix + name->value));
      case CommandKind::remove:
        break;
    }
    return false;
  });
}

void SceneBuilder::claim(NameSet& names, const CommandAttribute& name) {
  names.claim(name);
  built_.scene.undo().add([&names, key = name.value] { names.release(key); }, [&names, name] { names.claim(name); });
}

}  // namespace simvis
