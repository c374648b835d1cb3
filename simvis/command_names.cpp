#include "simvis/command_names.h"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include <simvis/attributes.h>
#include <simvis/element.h>
#include <simvis/sensor.h>
#include "scenegraph/language/command_attributes.h"
#include "scenegraph/language/pose_attribute.h"

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

std::optional<CommandKind> referred_kind(const Command& command, std::string_view attribute) {
  if (attribute == "insert_at" || attribute == kLookAt) return CommandKind::part;
  for (const AttributeSpec& spec : table_of(command)) {
    if (spec.name != attribute) continue;
    if (spec.kind == AttributeKind::part) return CommandKind::part;
    if (spec.kind == AttributeKind::element) return CommandKind::element;
    if (spec.kind == AttributeKind::sensor) return CommandKind::sensor;
  }
  return std::nullopt;
}

bool refers_to_file(const Command& command, const CommandAttribute& attribute) {
  return std::ranges::any_of(table_of(command), [&](const AttributeSpec& spec) {
    return spec.name == attribute.name && names_file(spec, attribute.value);
  });
}

std::string prefix_of(const Command& command) {
  return command.scope == nullptr ? std::string() : command.scope->prefix;
}

void prefix_names(std::vector<Command>& commands, const PartContent& content, const std::string& prefix) {
  std::set<std::pair<CommandKind, std::string>> own;
  for (const std::string& point : content.points) own.emplace(CommandKind::part, point);
  for (const Command& command : commands) {
    if (const CommandAttribute* name = command.find("name")) own.emplace(command.kind, name->value);
  }
  for (Command& command : commands) {
    for (CommandAttribute& attribute : command.attributes) {
      const std::optional<CommandKind> kind =
          attribute.name == "name" ? command.kind : referred_kind(command, attribute.name);
      if (kind && own.contains({*kind, attribute.value})) attribute.value = prefix + attribute.value;
    }
  }
}

}  // namespace simvis
