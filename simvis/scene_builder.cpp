#include "simvis/scene_builder.h"

#include <algorithm>
#include <set>

#include "scenegraph/name_set.h"
#include "scenegraph/pose_attribute.h"

namespace simvis {
namespace {

class Builder {
 public:
  Builder(std::span<const AttributeOverride> overrides, std::uint64_t seed) : overrides_(overrides), seed_(seed) {
    for (const AttributeOverride& override : overrides) {
      if (find_sensor_type(override.sensor_type) == nullptr) {
        fail_at(origin(override), unknown_type("sensor", override.sensor_type, sensor_types()));
      }
    }
  }

  void run(std::span<const Command> commands) {
    for (std::size_t i = 0; i < commands.size(); ++i) {
      check_order(commands[i], commands.subspan(i + 1));
      execute(commands[i]);
    }
  }

  BuiltScene take() { return std::move(built_); }

 private:
  template <typename Type>
  static std::string unknown_type(std::string_view family, std::string_view seen,
                                  const std::vector<const Type*>& types) {
    std::vector<std::string_view> known;
    std::string list;
    for (const Type* type : types) {
      known.push_back(type->name);
      list += (list.empty() ? "" : ", ") + std::string(type->name);
    }
    return "unknown " + std::string(family) + " type " + in_quotes(seen) + suggestion(seen, known) +
           " (expected one of: " + list + ")";
  }

  static Location origin(const AttributeOverride& override) {
    return {.file = override.origin.empty() ? override.sensor_type + "." + override.attribute : override.origin};
  }

  // Says so when the insertion point that a command names comes into being only later.
  void check_order(const Command& command, std::span<const Command> later) const {
    const CommandAttribute* at = command.find("insert_at");
    if (at == nullptr || built_.scene.has_insertion_point(at->value)) return;
    for (const Command& other : later) {
      const CommandAttribute* name = other.find("name");
      if (other.kind != CommandKind::part || name == nullptr || name->value != at->value) continue;
      fail_at(at->where, "there is no insertion point " + in_quotes(at->value) + " yet: its part stands later, at " +
                             to_string(other.where) + ", and commands are executed in order");
    }
  }

  void execute(const Command& command) {
    switch (command.kind) {
      case CommandKind::part:
        // Logged before what it carries.
        if (const PartContent& content = insert_part(command); !content.commands.empty()) run_carried(command, content);
        return;
      case CommandKind::element:
        insert_element(command);
        break;
      case CommandKind::sensor:
        insert_sensor(overridden(command));
        break;
    }
  }

  const PartContent& insert_part(const Command& command) {
    const PartContent& content = built_.scene.insert_part(command);
    built_.parameters.log_change(to_string(command));
    return content;
  }

  void run_carried(const Command& part, const PartContent& content) {
    if (std::ranges::find(open_, content.file) != open_.end()) {
      fail_at(part.where, "part file " + in_quotes(content.file.string()) + " carries a command that inserts itself");
    }
    open_.push_back(content.file);
    try {
      run(carried_commands(part, content));
    } catch (const InputError& error) {
      rethrow_from_part(part, error);
    }
    open_.pop_back();
  }

  std::vector<Command> carried_commands(const Command& part, const PartContent& content) {
    std::vector<Command> commands;
    for (std::size_t i = 0; i < content.commands.size(); ++i) {
      const std::string file = content.file.string() + "(command " + std::to_string(i + 1) + ")";
      const std::vector<Command> parsed = parse_commands(content.commands[i], file, content.file.parent_path());
      commands.insert(commands.end(), parsed.begin(), parsed.end());
    }
    const std::string& part_name = part.require("name").value;
    if (!carriers_.insert(content.file).second) prefix_names(commands, part);
    for (Command& command : commands) {
      if (command.find("insert_at") == nullptr) {
        command.attributes.push_back({"insert_at", part_name, command.where});
      }
    }
    return commands;
  }

  // Gives the carried commands of a part that stands in the scene already names of their own.
  static void prefix_names(std::vector<Command>& commands, const Command& part) {
    const CommandAttribute& part_name = part.require("name");
    if (part_name.value.starts_with('/') || part_name.value.find('.') != std::string::npos) {
      fail_at(part_name.where, "attribute \"name\": " + in_quotes(part_name.value) +
                                   " is not allowed for a second part of a file that carries commands, expected a "
                                   "name without '.' and without '/' in front");
    }
    std::set<std::string> own;
    for (const Command& command : commands) {
      if (const CommandAttribute* name = command.find("name"); name && command.kind == CommandKind::part) {
        own.insert(name->value);
      }
    }
    for (Command& command : commands) {
      for (CommandAttribute& attribute : command.attributes) {
        const bool refers = attribute.name == "insert_at" && own.contains(attribute.value);
        if (attribute.name == "name" || refers) attribute.value = part_name.value + "/" + attribute.value;
      }
    }
  }

  void insert_element(const Command& command) {
    const CommandAttribute& type_name = command.require("type");
    const CommandAttribute& name = command.require("name");
    const CommandAttribute& insert_at = command.require("insert_at");
    const ElementType* type = find_element_type(type_name.value);
    if (type == nullptr) fail_at(type_name.where, unknown_type("element", type_name.value, element_types()));
    const AttributeValues attributes(command, type->attributes, kElementCommonAttributes);
    element_names_.claim(name);
    std::unique_ptr<Element> element =
        type->create({.command = command, .attributes = attributes, .scene = built_.scene});

    ElementDescriptor descriptor{
        .name = name.value, .type = type_name.value, .insertion_point = insert_at.value, .parameters = {}};
    std::ranges::copy_if(type->attributes, std::back_inserter(descriptor.parameters), &AttributeSpec::live);
    element->limit_parameters(descriptor.parameters);
    std::vector<double> values;
    for (const AttributeSpec& row : descriptor.parameters) {
      values.push_back(attributes.number(row.name));
      const std::string wrong = check_number(row, values.back());
      if (!wrong.empty()) fail_at(attributes.where(row.name), "attribute " + in_quotes(row.name) + ": " + wrong);
    }
    built_.parameters.add_element(std::move(descriptor), values);
    element->update(values);
    built_.elements.push_back(std::move(element));
    built_.parameters.log_change(to_string(command));
  }

  Command overridden(Command command) const {
    const CommandAttribute& type = command.require("type");
    const std::string type_name = type.value;
    for (const AttributeOverride& override : overrides_) {
      if (override.sensor_type != type_name) continue;
      std::erase_if(command.attributes, [&](const CommandAttribute& a) { return a.name == override.attribute; });
      command.attributes.push_back({override.attribute, override.value, origin(override)});
    }
    return command;
  }

  void insert_sensor(const Command& command) {
    const CommandAttribute& type_name = command.require("type");
    const CommandAttribute& name = command.require("name");
    command.require("insert_at");
    const SensorType* type = find_sensor_type(type_name.value);
    if (type == nullptr) fail_at(type_name.where, unknown_type("sensor", type_name.value, sensor_types()));
    const AttributeValues attributes(command, type->attributes, kSensorCommonAttributes);
    const std::optional<glm::dmat4> offset = pose_offset(command);
    sensor_names_.claim(name);
    BuiltSensor sensor{
        .name = name.value,
        .type = type_name.value,
        .sensor = type->create({.command = command, .attributes = attributes, .name = name.value, .seed = seed_}),
        .mount = std::make_shared<Mount>()};
    if (std::ranges::count(type->attributes, kRateAttribute.name, &AttributeSpec::name) == 1 &&
        attributes.is_set(kRateAttribute.name)) {
      sensor.sensor->rate_hz = attributes.number(kRateAttribute.name);
    }
    sensor.mount->name = name.value;
    const auto separator = std::make_shared<Separator>();
    separator->name = name.value;
    if (offset) separator->add(std::make_shared<Transform>(*offset));
    separator->add(sensor.mount);
    built_.scene.insert(command, separator);
    built_.sensors.push_back(std::move(sensor));
    built_.parameters.log_change(to_string(command));
  }

  std::span<const AttributeOverride> overrides_;
  std::uint64_t seed_;
  BuiltScene built_;
  NameSet element_names_{"element"}, sensor_names_{"sensor"};
  std::set<std::filesystem::path> carriers_;  // files whose carried commands were executed before
  std::vector<std::filesystem::path> open_;   // files whose carried commands are being executed
};

}  // namespace

BuiltScene build_scene(std::span<const Command> commands, std::span<const AttributeOverride> overrides,
                       std::uint64_t seed) {
  Builder builder(overrides, seed);
  builder.run(commands);
  return builder.take();
}

}  // namespace simvis
