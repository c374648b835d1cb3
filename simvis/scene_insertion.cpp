// The commands that insert: parts, elements and sensors.
#include <algorithm>
#include <array>
#include <iterator>
#include <new>
#include <optional>
#include <system_error>
#include <utility>

#include "elements/randomize.h"
#include "engine/base/assert.h"
#include "scenegraph/language/control_characters.h"
#include "scenegraph/language/pose_attribute.h"
#include "scenegraph/language/registrations.h"
#include "sensors/delayed_sensor.h"
#include "simvis/command_names.h"
#include "simvis/library_of.h"
#include "simvis/look_at.h"
#include "simvis/ros/sensor_topics.h"
#include "simvis/scene_builder.h"

namespace simvis {
namespace {

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
  } catch (const std::bad_alloc&) {
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

}  // namespace

// Throws InputError for an override of a type that does not exist.
void SceneBuilder::check_override(const AttributeOverride& override) {
  if (find_sensor_type(override.sensor_type) != nullptr) return;
  fail_at(origin(override), unknown_type("sensor", override.sensor_type, sensor_types()));
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
  if (std::ranges::any_of(prefix.value, is_control)) {
    fail_at(prefix.where, "attribute \"logged_prefix\": control characters are not allowed");
  }
  const Command plain = without(command, kLoggedPrefix);
  const PartContent& content = built_.scene.insert_part(plain, prefix.value);
  note_carrier({prefix_of(command), content.file});
  remember(plain, false);
  note_made(plain, {}, first_step);
  log_change(command);
}

// Names of parts and elements must exist; names of sensors are checked when all commands have been executed.
void SceneBuilder::check_references(const AttributeValues& attributes, AttributeTable table) {
  for (const AttributeSpec& spec : table) {
    if (!is_reference(spec.kind) || !attributes.is_set(spec.name)) continue;
    const std::string& name = attributes.text(spec.name);
    const Location& where = attributes.where(spec.name);
    if (spec.kind == AttributeKind::part && !built_.scene.has_part(name)) {
      fail_at(where, built_.scene.objects().unknown("part", name) + " (expected the name of a part inserted before)");
    }
    if (spec.kind == AttributeKind::object) built_.scene.find_object("part or link", name, where);
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

Element* SceneBuilder::find_element(std::string_view name) const {
  const std::vector<ElementDescriptor>& elements = built_.parameters.elements();
  const auto found =
      std::ranges::find_if(elements, [&](const ElementDescriptor& each) { return !each.removed && each.name == name; });
  return found == elements.end() ? nullptr : built_.elements[static_cast<std::size_t>(found - elements.begin())].get();
}

// The parameter of an element that exists, and that no other command draws.
void SceneBuilder::bind(RandomizeElement& randomized) const {
  const Parameters& parameters = built_.parameters;
  std::size_t index = 0;
  try {
    index = parameters.index(randomized.element(), randomized.parameter());
  } catch (const InputError& error) {
    fail_at(randomized.parameter_at(), error.what());
  }
  for (const std::unique_ptr<Element>& each : built_.elements) {
    const auto* const other = dynamic_cast<const RandomizeElement*>(each.get());
    if (other == nullptr || other->index() != index) continue;
    fail_at(randomized.parameter_at(), in_quotes(parameters.name(index)) +
                                           " is drawn by another element of type "
                                           "randomize, expected one for each parameter");
  }
  randomized.bind(index, parameters.spec(index), seed_);
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
                         .find_element = [this](std::string_view other) { return find_element(other); },
                         .seed = seed_});
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
  if (auto* const randomized = dynamic_cast<RandomizeElement*>(element.get())) bind(*randomized);
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
  check_message_names(command);
  check_references(attributes, table);
  claim(sensor_names_, name);
  BuiltSensor sensor{
      .id = built_.next_sensor_id++,
      .name = name.value,
      .type = type_name.value,
      .command = command,
      .outputs = outputs_of(*type, command),
      .sensor = create(*type, command,
                       [&] {
                         return type->create(
                             {.command = command, .attributes = attributes, .name = name.value, .seed = seed_});
                       }),
      .mount = nullptr};
  if (const TimingFaults faults = TimingFaults::of(attributes); faults != TimingFaults{}) {
    auto delayed =
        std::make_unique<DelayedSensor>(std::move(sensor.sensor), faults, SensorRandom(seed_, sensor.name + "/timing"));
    sensor.delayed = delayed.get();
    sensor.sensor = std::move(delayed);
  }
  if (limits_ && sensor.sensor->draws()) sensor.sensor->check(limits_());
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

// Another process, in another folder, makes the same of the logged command.
void SceneBuilder::log_change(Command command) {
  for (CommandAttribute& attribute : command.attributes) {
    if (!refers_to_file(command, attribute)) continue;
    std::error_code error;
    const std::filesystem::path path = std::filesystem::weakly_canonical(command.folder / attribute.value, error);
    if (!error) attribute.value = path.string();
  }
  built_.parameters.log_change(to_string(command));
  built_.scene.undo().add_for_roll_back([this] { built_.parameters.remove_last_change(); });
}

}  // namespace simvis
