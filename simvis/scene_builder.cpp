#include "simvis/scene_builder.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <system_error>
#include <utility>

#include "engine/base/assert.h"
#include "scenegraph/language/command_reader.h"
#include "scenegraph/language/pose_attribute.h"
#include "scenegraph/language/registrations.h"
#include "simvis/library_of.h"
#include "simvis/look_at.h"

namespace simvis {
namespace {

// Limit of the nesting depth of parts; a greater depth is taken for an error.
constexpr std::size_t kMaxNested = 64;

constexpr std::string_view kReading = "reading the scene";

// Attributes in a log of changes: of a part, what stands in front of the names in its file; of a sensor with look_at,
// the offset that followed from it.
constexpr std::string_view kLoggedPrefix = "logged_prefix", kLoggedOffset = "logged_offset";

// Creates an element or a sensor. An exception from the constructor of its type becomes an error at the command.
template <typename Type, typename Create>
auto create(const Type& type, const Command& command, const Create& make) {
  std::string reason = "it returned nothing";
  try {
    if (auto made = make()) return made;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    reason = error.what();
  } catch (...) {
    reason = "it threw an object that is not a std::exception";
  }
  fail_at(command.where, "type " + in_quotes(type.name) + " of " +
                             library_of(reinterpret_cast<const void*>(type.create)) +
                             " could not be created: " + reason);
}

template <typename Type>
std::string unknown_type(std::string_view family, std::string_view seen, const std::vector<const Type*>& types) {
  std::vector<std::string_view> known;
  std::string list;
  for (const Type* type : types) {
    known.push_back(type->name);
    list += (list.empty() ? "" : ", ") + std::string(type->name);
  }
  return "unknown " + std::string(family) + " type " + in_quotes(seen) + suggestion(seen, known) +
         " (expected one of: " + list + ")";
}

Location origin(const AttributeOverride& override) {
  return {.file = override.origin.empty() ? override.sensor_type + "." + override.attribute : override.origin};
}

// The attribute table of the command's type; empty for parts and unknown types.
std::vector<AttributeSpec> table_of(const Command& command) {
  const CommandAttribute* const type = command.find("type");
  if (type == nullptr) return {};
  if (command.kind == CommandKind::element) {
    const ElementType* const element = find_element_type(type->value);
    if (element == nullptr) return {};
    return {element->attributes.begin(), element->attributes.end()};
  }
  const SensorType* const sensor = find_sensor_type(type->value);
  if (command.kind == CommandKind::part || sensor == nullptr) return {};
  return all_attributes(*sensor);
}

// The kind of object that an attribute of a command refers to.
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

std::string prefix_of(const Command& command) {
  return command.scope == nullptr ? std::string() : command.scope->prefix;
}

void check_prefix(const CommandAttribute& part_name) {
  if (!part_name.value.starts_with('/') && part_name.value.find('.') == std::string::npos) return;
  fail_at(part_name.where, "attribute \"name\": " + in_quotes(part_name.value) +
                               " is not allowed for a part whose file defines names, expected a "
                               "name without '.' and without '/' in front");
}

void check_no_pose_offset(const Command& command, const ElementType& type) {
  const CommandAttribute* const offset = command.find(kPoseOffset);
  if (offset == nullptr || std::ranges::count(type.attributes, kPoseOffset, &AttributeSpec::name) > 0) return;
  fail_at(offset->where,
          "attribute \"pose_offset\" is not allowed on an element, expected it on a part or a sensor, or an element of "
          "type \"pose\" in front of this one");
}

// Whether an element moves or turns what follows it: its node is a transform, and it has lengths or angles.
bool is_mover(const ElementType& type, const NodePtr& node) {
  if (node == nullptr || node->kind() != NodeKind::transform) return false;
  return std::ranges::any_of(type.attributes,
                             [](const AttributeSpec& row) { return row.unit == "m" || row.unit.starts_with("deg"); });
}

// Where the target of look_at stands belongs to the moment, so the log has the matrix: its first three rows, column by
// column.
void write_offset(const glm::dmat4& offset, Command& command) {
  std::erase_if(command.attributes,
                [](const CommandAttribute& each) { return each.name == kLookAt || each.name == kPoseOffset; });
  std::string numbers;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row) {
      numbers += (numbers.empty() ? "" : " ") + format_number(offset[column][row]);
    }
  }
  command.attributes.push_back({std::string(kLoggedOffset), numbers, command.where});
}

glm::dmat4 read_offset(const CommandAttribute& attribute) {
  std::array<double, 12> numbers{};
  if (!parse_numbers(attribute.value, numbers)) {
    fail_at(attribute.where, "attribute \"logged_offset\": expected 12 finite numbers");
  }
  glm::dmat4 offset(1);
  for (int i = 0; i < 12; ++i) offset[i / 3][i % 3] = numbers[static_cast<std::size_t>(i)];
  return offset;
}

Command without(Command command, std::string_view attribute) {
  std::erase_if(command.attributes, [&](const CommandAttribute& each) { return each.name == attribute; });
  return command;
}

// Adds the prefix to the names that a part file defines, and to its references to them.
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

}  // namespace

SceneBuilder::SceneBuilder(BuiltScene& built, std::span<const AttributeOverride> overrides, std::uint64_t seed,
                           ProgressCallback progress)
    : built_(built), overrides_(overrides), seed_(seed), progress_(std::move(progress)) {
  Registrations::instance().require_none_refused();
  built_.scene.postpone_pictures();
  for (const AttributeOverride& override : overrides) {
    if (find_sensor_type(override.sensor_type) == nullptr) {
      fail_at(origin(override), unknown_type("sensor", override.sensor_type, sensor_types()));
    }
  }
}

template <typename Action>
void SceneBuilder::all_or_nothing(const Action& action) {
  const std::uint64_t first_made = next_made_;
  try {
    action();
    check_awaited(first_made);
    warn_of_unmoved_sensors();
    if (shows_colors()) built_.scene.read_pictures();
  } catch (...) {
    built_.scene.undo().roll_back();
    open_.clear();
    open_parts_.clear();
    removed_ = false;
    announced_sensors_.clear();
    inserted_.clear();
    throw;
  }
  announced_sensors_.clear();
  copied_.clear();
  built_.scene.undo().commit();
  if (std::exchange(removed_, false)) built_.scene.forget_unused_content();
}

bool SceneBuilder::shows_colors() const {
  return std::ranges::any_of(built_.sensors,
                             [](const BuiltSensor& sensor) { return sensor.sensor->color() != nullptr; });
}

void SceneBuilder::execute(std::span<const Command> commands) {
  all_or_nothing([&] {
    announce(commands);
    run(commands);
  });
  if (progress_ && !commands.empty()) progress_({kReading, commands.size(), commands.size()});
}

void SceneBuilder::add_variant(std::size_t sensor, const Command& command) {
  all_or_nothing([&] {
    const std::size_t first_step = built_.scene.undo().size();
    BuiltSensor variant = make_sensor(command);
    const BuiltSensor& of = built_.sensors[sensor];
    // People and sensors have separate worlds, and a mount belongs to one of them.
    if (variant.type != of.type || variant.sensor->visualization() != of.sensor->visualization()) {
      fail_at(command.where, "a variant of sensor " + in_quotes(of.name) + " must have its type and view");
    }
    variant.mount = of.mount;
    const auto original = std::ranges::find_if(made_, [&](const auto& each) {
      return each.second.kind == CommandKind::sensor && each.second.name == of.name;
    });
    SIMVIS_ASSERT(original != made_.end());
    open_parts_.push_back(original->first);  // it goes with the sensor whose mount it has
    add_sensor(std::move(variant));
    note_made(command, {}, first_step);
    open_parts_.pop_back();
  });
}

void SceneBuilder::require(const TargetLimits& limits) {
  limits_ = limits;
  for (const BuiltSensor& sensor : built_.sensors) sensor.sensor->check(limits);
}

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

void SceneBuilder::run(std::span<const Command> commands) {
  note_copies(commands);
  for (std::size_t i = 0; i < commands.size(); ++i) {
    if (progress_ && open_.empty()) progress_({kReading, i, commands.size()});
    check_order(commands[i], commands.subspan(i + 1));
    execute_one(commands[i]);
  }
}

// Throws if the insertion point that a command names is created only by a later command.
void SceneBuilder::check_order(const Command& command, std::span<const Command> later) const {
  const CommandAttribute* at = command.find("insert_at");
  if (at == nullptr || built_.scene.has_insertion_point(at->value)) return;
  if (built_.scene.has_insertion_point(prefix_of(command) + at->value)) return;
  for (const Command& other : later) {
    const CommandAttribute* name = other.find("name");
    if (other.kind != CommandKind::part || name == nullptr || name->value != at->value) continue;
    if (prefix_of(other) != prefix_of(command)) continue;
    fail_at(at->where, "there is no insertion point " + in_quotes(at->value) + " yet: its part comes later, at " +
                           to_string(other.where) + ", and commands are executed in order");
  }
}

// Sensors may be referred to before their commands.
void SceneBuilder::announce(std::span<const Command> commands) {
  for (const Command& command : commands) {
    const CommandAttribute* const name = command.find("name");
    if (command.kind != CommandKind::sensor || command.scope == nullptr || name == nullptr) continue;
    announced_sensors_.insert(command.scope->prefix + name->value);
  }
}

// Gives the names in a command of an included file as the whole scene knows them.
Command SceneBuilder::named(Command command) const {
  for (CommandAttribute& attribute : command.attributes) {
    if (attribute.name == "name") {
      attribute.value = command.scope->prefix + attribute.value;
    } else if (const std::optional<CommandKind> kind = referred_kind(command, attribute.name)) {
      resolve(*kind, attribute, command.scope.get());
    }
  }
  return command;
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

void SceneBuilder::execute_one(const Command& command) {
  if (command.kind == CommandKind::remove) return remove(command);
  if (command.scope == nullptr) return execute_named(command);
  execute_named(named(command));
}

void SceneBuilder::execute_named(const Command& command) {
  switch (command.kind) {
    case CommandKind::part:
      return insert_part(command);
    case CommandKind::element:
      return insert_element(command);
    case CommandKind::sensor:
      return insert_sensor(overridden(command));
    case CommandKind::remove:
      SIMVIS_ASSERT(!"execute_one() removes");
  }
}

// Another process, in another folder, makes the same of the logged command.
void SceneBuilder::log_change(Command command) {
  for (CommandAttribute& attribute : command.attributes) {
    if (attribute.name != "file") continue;
    std::error_code error;
    const std::filesystem::path path = std::filesystem::weakly_canonical(command.folder / attribute.value, error);
    if (!error) attribute.value = path.string();
  }
  built_.parameters.log_change(to_string(command));
  built_.scene.undo().add_for_roll_back([this] { built_.parameters.remove_last_change(); });
}

void SceneBuilder::insert_part(const Command& command) {
  if (command.find(kLoggedPrefix) != nullptr) return insert_logged_part(command);
  const std::size_t first_step = built_.scene.undo().size();
  const PartContent& content = built_.scene.load_part(command);
  const CommandAttribute& name = command.require("name");
  const bool has_names = !content.commands.empty() || !content.points.empty();
  std::string prefix = prefix_of(command);
  const Carrier carrier(prefix, content.file);
  if (has_names && clashes(content.commands.empty() ? std::vector<Command>() : carried_commands(command, content),
                           content, prefix, name.value)) {
    check_prefix(name);
    prefix = name.value + "/";
  }
  built_.scene.insert_part(command, prefix);
  if (has_names) note_carrier(carrier);
  remember(command, false);
  note_made(command, {}, first_step);
  Command logged = command;
  if (has_names) logged.attributes.push_back({std::string(kLoggedPrefix), prefix, command.where});
  log_change(std::move(logged));  // before the carried commands
  if (!has_names) return;
  open_parts_.push_back(next_made_ - 1);
  run_carried(command, content, prefix);
  open_parts_.pop_back();
}

// The command of a log says which prefix the names in the part have. The commands that the file carries follow it in
// the log.
void SceneBuilder::insert_logged_part(const Command& command) {
  const std::size_t first_step = built_.scene.undo().size();
  const CommandAttribute& prefix = command.require(kLoggedPrefix);
  if (std::ranges::any_of(prefix.value, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; })) {
    fail_at(prefix.where, "attribute \"logged_prefix\": control characters are not allowed");
  }
  const Command plain = without(command, kLoggedPrefix);
  const PartContent& content = built_.scene.insert_part(plain, prefix.value);
  note_carrier({prefix_of(command), content.file});
  remember(plain, false);
  note_made(plain, {}, first_step);
  log_change(command);
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
        return sensor_names_.contains(prefix + name->value);
      case CommandKind::remove:
        break;
    }
    return false;
  });
}

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
  try {
    run(commands);
  } catch (const InputError& error) {
    rethrow_from_part(part, error);
  }
  open_.pop_back();
}

std::vector<Command> SceneBuilder::carried_commands(const Command& part, const PartContent& content) const {
  std::vector<Command> commands;
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
    if (command.find("insert_at") == nullptr) {
      command.attributes.push_back({"insert_at", part.require("name").value, command.where});
    }
  }
  return commands;
}

// Names of parts and elements must exist; names of sensors are checked when all commands have been executed.
void SceneBuilder::check_references(const AttributeValues& attributes, AttributeTable table) {
  for (const AttributeSpec& spec : table) {
    if (!is_reference(spec.kind) || !attributes.is_set(spec.name)) continue;
    const std::string& name = attributes.text(spec.name);
    const Location& where = attributes.where(spec.name);
    if (spec.kind == AttributeKind::part && !built_.scene.has_part(name)) {
      fail_at(where, "there is no part " + in_quotes(name) + suggestion(name, built_.scene.part_names()) +
                         " (expected the name of a part inserted before)");
    }
    if (spec.kind == AttributeKind::element && find_element(name) == nullptr) {
      std::vector<std::string_view> known;
      for (const ElementDescriptor& element : built_.parameters.elements()) {
        if (!element.removed) known.push_back(element.name);
      }
      fail_at(where, "there is no element " + in_quotes(name) + suggestion(name, known) +
                         " (expected the name of an element inserted before)");
    }
  }
}

// Sensors that the commands since `first_made` refer to must exist by now, and must produce scans.
void SceneBuilder::check_awaited(std::uint64_t first_made) const {
  std::vector<std::string_view> known;
  for (const BuiltSensor& sensor : built_.sensors) {
    if (sensor.sensor->scan() != nullptr) known.push_back(sensor.name);
  }
  for (auto made = made_.lower_bound(first_made); made != made_.end(); ++made) {
    for (const Made::Reference& each : made->second.references) {
      if (each.kind != CommandKind::sensor || std::ranges::find(known, each.name) != known.end()) continue;
      fail_at(each.where, "there is no sensor " + in_quotes(each.name) + " that gives scans" +
                              suggestion(each.name, known) + " (expected the name of a scanner of the scene)");
    }
  }
}

void SceneBuilder::remember(const Command& command, bool moves) {
  inserted_.push_back(
      {command.kind, moves, command.require("name").value, command.require("insert_at").value, command.where});
  if (command.kind == CommandKind::element) return;
  const auto add = [this, name = inserted_.back().name, kind = to_string(command.kind)] {
    built_.parameters.add_other(name, kind);
  };
  add();
  built_.scene.undo().add([this, name = inserted_.back().name,
                           kind = to_string(command.kind)] { built_.parameters.remove_other(name, kind); },
                          add);
}

// The last step of a command: whatever was added to the undo log since `first_step` is its own.
void SceneBuilder::note_made(const Command& command, AttributeTable table, std::size_t first_step) {
  Made made{.kind = command.kind,
            .name = command.require("name").value,
            .insert_at = command.require("insert_at").value,
            .where = command.where,
            .references = {},
            .points = {},
            .carrier = {},
            .steps = built_.scene.undo().steps_since(first_step)};
  for (const AttributeSpec& spec : table) {
    const CommandAttribute* const attribute = is_reference(spec.kind) ? command.find(spec.name) : nullptr;
    if (attribute == nullptr) continue;
    made.references.push_back(
        {*referred_kind(command, spec.name), attribute->name, attribute->value, attribute->where});
  }
  if (command.kind == CommandKind::part) made.points = built_.scene.points_of_part(made.name);
  if (!open_parts_.empty()) made.carrier = open_parts_.back();
  made_.emplace(next_made_, std::move(made));
  built_.scene.undo().add_for_roll_back([this, id = next_made_++] { made_.erase(id); });
}

// Warns of a sensor that no element moves although the next element at its insertion point could have been meant to:
// one that moves the content of a part without the sensor in front of it, or one that moves nothing at all.
void SceneBuilder::warn_of_unmoved_sensors() {
  for (std::size_t mover = 0; mover < inserted_.size(); ++mover) {
    const Inserted& element = inserted_[mover];
    if (!element.moves) continue;
    const auto same_place = [&](const Inserted& each) { return each.insert_at == element.insert_at; };
    const auto before = std::span(inserted_).first(mover), behind = std::span(inserted_).subspan(mover + 1);
    if (std::ranges::any_of(before, [&](const Inserted& each) { return each.moves && same_place(each); })) continue;
    if (!built_.scene.has_part(element.insert_at) && std::ranges::any_of(behind, same_place)) continue;
    for (const Inserted& sensor : before) {
      if (sensor.kind != CommandKind::sensor || !same_place(sensor)) continue;
      built_.scene.warn(sensor.where, "sensor " + in_quotes(sensor.name) + " does not move with element " +
                                          in_quotes(element.name) + ", which comes later at insertion point " +
                                          in_quotes(element.insert_at) +
                                          " and moves only what follows it; expected the sensor behind the element");
    }
  }
  inserted_.clear();
}

Element* SceneBuilder::find_element(std::string_view name) const {
  const std::vector<ElementDescriptor>& elements = built_.parameters.elements();
  const auto found =
      std::ranges::find_if(elements, [&](const ElementDescriptor& each) { return !each.removed && each.name == name; });
  return found == elements.end() ? nullptr : built_.elements[static_cast<std::size_t>(found - elements.begin())].get();
}

void SceneBuilder::insert_element(const Command& command) {
  const CommandAttribute& type_name = command.require("type");
  const CommandAttribute& name = command.require("name");
  const CommandAttribute& insert_at = command.require("insert_at");
  const ElementType* type = find_element_type(type_name.value);
  if (type == nullptr) fail_at(type_name.where, unknown_type("element", type_name.value, element_types()));
  check_no_pose_offset(command, *type);
  const AttributeValues attributes(command, type->attributes, kElementCommonAttributes);
  check_references(attributes, type->attributes);
  const std::size_t first_step = built_.scene.undo().size();
  claim(element_names_, name);
  std::unique_ptr<Element> element = create(*type, command, [&] {
    return type->create({.command = command,
                         .attributes = attributes,
                         .scene = built_.scene,
                         .find_element = [this](std::string_view other) { return find_element(other); }});
  });

  ElementDescriptor descriptor{
      .name = name.value, .type = type_name.value, .insertion_point = insert_at.value, .parameters = {}};
  std::ranges::copy_if(type->attributes, std::back_inserter(descriptor.parameters), &AttributeSpec::live);
  element->adapt_parameters(descriptor.parameters);
  std::vector<double> values;
  for (const AttributeSpec& row : descriptor.parameters) {
    const bool added = std::ranges::count(type->attributes, row.name, &AttributeSpec::name) == 0;
    values.push_back(0);
    if (added) SIMVIS_ASSERT(parse_number(row.default_value, values.back()));
    if (!added) values.back() = attributes.number(row.name);
    const std::string wrong = check_number(row, values.back());
    if (added) SIMVIS_ASSERT(wrong.empty());
    if (!wrong.empty()) fail_at(attributes.where(row.name), "attribute " + in_quotes(row.name) + ": " + wrong);
    values.back() = std::clamp(values.back(), row.min, row.max);  // see AttributeSpec::rounding
  }
  built_.parameters.add_element(std::move(descriptor), values);
  element->update(values);
  built_.elements.push_back(std::move(element));
  built_.scene.undo().add_for_roll_back([this] {
    built_.elements.pop_back();
    built_.parameters.remove_last_element();
  });
  remember(command, is_mover(*type, built_.scene.find_node(name.value)));
  note_made(command, type->attributes, first_step);
  log_change(command);
}

Command SceneBuilder::overridden(Command command) const {
  const CommandAttribute& type = command.require("type");
  const std::string type_name = type.value;
  for (const AttributeOverride& override : overrides_) {
    if (override.sensor_type != type_name) continue;
    std::erase_if(command.attributes, [&](const CommandAttribute& a) { return a.name == override.attribute; });
    if (override.value) command.attributes.push_back({override.attribute, *override.value, origin(override)});
  }
  return command;
}

// Creates the sensor; add_sensor() puts it into the scene graph.
BuiltSensor SceneBuilder::make_sensor(const Command& written) {
  const CommandAttribute& type_name = written.require("type");
  const CommandAttribute& name = written.require("name");
  const SensorType* type = find_sensor_type(type_name.value);
  if (type == nullptr) fail_at(type_name.where, unknown_type("sensor", type_name.value, sensor_types()));
  const Command command = with_preset(written, *type);
  const std::vector<AttributeSpec> table = all_attributes(*type);
  const AttributeValues attributes(command, table, kSensorCommonAttributes);
  check_references(attributes, table);
  claim(sensor_names_, name);
  BuiltSensor sensor{
      .id = built_.next_sensor_id++,
      .name = name.value,
      .type = type_name.value,
      .command = command,
      .sensor = create(*type, command,
                       [&] {
                         return type->create(
                             {.command = command, .attributes = attributes, .name = name.value, .seed = seed_});
                       }),
      .mount = nullptr};
  if (limits_) sensor.sensor->check(*limits_);
  if (std::ranges::count(type->attributes, kRateAttribute.name, &AttributeSpec::name) == 1 &&
      attributes.is_set(kRateAttribute.name)) {
    sensor.sensor->rate_hz = attributes.number(kRateAttribute.name);
  }
  return sensor;
}

void SceneBuilder::add_sensor(BuiltSensor sensor) {
  built_.sensors.push_back(std::move(sensor));
  built_.scene.undo().add_for_roll_back([this] { built_.sensors.pop_back(); });
}

void SceneBuilder::claim(NameSet& names, const CommandAttribute& name) {
  names.claim(name);
  built_.scene.undo().add([&names, key = name.value] { names.release(key); }, [&names, name] { names.claim(name); });
}

void SceneBuilder::insert_sensor(const Command& command) {
  for (const char* attribute : {"type", "name", "insert_at"}) command.require(attribute);
  const std::size_t first_step = built_.scene.undo().size();
  BuiltSensor sensor = make_sensor(without(command, kLoggedOffset));
  std::optional<glm::dmat4> offset = pose_offset(command);
  if (const CommandAttribute* const logged_offset = command.find(kLoggedOffset)) offset = read_offset(*logged_offset);
  Command logged = command;
  if (command.find(kLookAt) != nullptr) {
    offset = look_at_offset(built_.scene, command, (*offset)[3]);
    write_offset(*offset, logged);
  }
  sensor.mount = std::make_shared<Mount>();
  sensor.mount->name = sensor.name;
  // Visualization sensors must have no effect on the world of the other sensors.
  const GroupPtr separator = sensor.sensor->visualization() ? GroupPtr(std::make_shared<VisualSeparator>())
                                                            : GroupPtr(std::make_shared<Separator>());
  separator->name = sensor.name;
  if (offset) separator->add(std::make_shared<Transform>(*offset));
  separator->add(sensor.mount);
  built_.scene.insert(command, separator);
  add_sensor(std::move(sensor));
  remember(command, false);
  note_made(command, all_attributes(*find_sensor_type(command.require("type").value)), first_step);
  log_change(std::move(logged));
}

BuiltScene build_scene(std::span<const Command> commands, std::span<const AttributeOverride> overrides) {
  BuiltScene built;
  SceneBuilder(built, overrides).execute(commands);
  return built;
}

}  // namespace simvis
