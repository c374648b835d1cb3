#include "simvis/command_names.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/element.h>
#include <simvis/sensor.h>
#include "engine/base/words.h"
#include "scenegraph/language/command_attributes.h"
#include "scenegraph/language/pose_attribute.h"
#include "scenegraph/language/topic_name.h"

namespace simvis {
namespace {

// The attribute table of the command's type; empty for unknown types.
std::vector<AttributeSpec> table_of(const Command& command) {
  if (command.kind == CommandKind::part) {
    std::vector<AttributeSpec> rows(std::begin(kPartCommonRows), std::end(kPartCommonRows));
    rows.insert(rows.end(), Scene::part_attributes().begin(), Scene::part_attributes().end());
    return rows;
  }
  const CommandAttribute* const type = command.find("type");
  if (type == nullptr) return {};
  if (command.kind == CommandKind::element) {
    const ElementType* const element = find_element_type(type->value);
    if (element == nullptr) return {};
    return {element->attributes.begin(), element->attributes.end()};
  }
  const SensorType* const sensor = find_sensor_type(type->value);
  return sensor == nullptr ? std::vector<AttributeSpec>() : all_attributes(*sensor);
}

}  // namespace

std::map<std::string, AttributeKind, std::less<>> reference_kinds(const Command& command) {
  std::map<std::string, AttributeKind, std::less<>> kinds{{"insert_at", AttributeKind::object},
                                                          {std::string(kLookAt), AttributeKind::object}};
  for (const AttributeSpec& spec : table_of(command)) {
    if (is_reference(spec.kind) || spec.kind == AttributeKind::objects) kinds.emplace(spec.name, spec.kind);
  }
  return kinds;
}

std::optional<CommandKind> referred_kind(AttributeKind kind) {
  if (kind == AttributeKind::part || kind == AttributeKind::object) return CommandKind::part;
  if (kind == AttributeKind::element) return CommandKind::element;
  if (kind == AttributeKind::sensor) return CommandKind::sensor;
  return std::nullopt;
}

// A text with spaces may be one name.
std::string with_prefixes(const std::string& value, const std::function<std::string(const std::string&)>& prefix_of) {
  if (const std::string prefix = prefix_of(value); !prefix.empty()) return prefix + value;
  std::string prefixed;
  for (const std::string_view each : words_of(value)) {
    const std::string word(each);
    prefixed += (prefixed.empty() ? "" : " ") + prefix_of(word) + word;
  }
  return prefixed.size() > value.size() ? prefixed : value;
}

bool refers_to_file(const Command& command, const CommandAttribute& attribute) {
  return std::ranges::any_of(table_of(command), [&](const AttributeSpec& spec) {
    return spec.name == attribute.name && names_file(spec, attribute.value);
  });
}

std::string prefix_of(const Command& command) {
  return command.scope == nullptr ? std::string() : command.scope->prefix;
}

namespace {

// Puts the topics of an attribute `topics` below the prefix of a part, so that those of two equal robots differ.
void add_namespace(std::string& topics, const std::string& prefix) {
  constexpr std::string_view kIs = ":=";
  const std::string space = topic_name(prefix, "");
  for (std::size_t at = topics.find(kIs); at != topics.npos; at = topics.find(kIs, at + kIs.size())) {
    topics.insert(at + kIs.size(), space.substr(0, space.find_last_not_of('/') + 1));
  }
}

}  // namespace

void prefix_names(std::vector<Command>& commands, const PartContent& content, const std::string& prefix) {
  std::set<std::pair<CommandKind, std::string>> own;
  for (const std::string& point : content.points) own.emplace(CommandKind::part, point);
  for (const Command& command : commands) {
    if (const CommandAttribute* name = command.find("name")) own.emplace(command.kind, name->value);
  }
  const auto prefix_of_pattern = [&](const std::string& pattern) {
    const bool is_own = std::ranges::any_of(own, [&](const auto& each) {
      return each.first == CommandKind::part && matches_pattern(pattern, each.second);
    });
    return is_own ? prefix : std::string();
  };
  for (Command& command : commands) {
    const std::map<std::string, AttributeKind, std::less<>> kinds = reference_kinds(command);
    for (CommandAttribute& attribute : command.attributes) {
      const auto reference = kinds.find(attribute.name);
      if (reference != kinds.end() && reference->second == AttributeKind::objects) {
        attribute.value = with_prefixes(attribute.value, prefix_of_pattern);
        continue;
      }
      std::optional<CommandKind> kind;
      if (attribute.name == "name") kind = command.kind;
      if (reference != kinds.end()) kind = referred_kind(reference->second);
      if (kind && own.contains({*kind, attribute.value})) attribute.value = prefix + attribute.value;
      if (command.kind == CommandKind::sensor && attribute.name == "frame") attribute.value = prefix + attribute.value;
      if (command.kind == CommandKind::sensor && attribute.name == "topics") add_namespace(attribute.value, prefix);
    }
  }
}

}  // namespace simvis
