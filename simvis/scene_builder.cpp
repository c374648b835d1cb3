#include "simvis/scene_builder.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"
#include "scenegraph/language/registrations.h"
#include "simvis/command_names.h"
#include "simvis/library_of.h"

namespace simvis {
namespace {

constexpr std::string_view kReading = "reading the scene";

}  // namespace

std::optional<std::string> need_of_shapes(std::span<const Command> commands, const SensorSelection& is_on) {
  bool has_sensor = false;
  for (const Command& command : commands) {
    const CommandAttribute *const type = command.find("type"), *const name = command.find("name");
    if (command.kind != CommandKind::sensor || type == nullptr || name == nullptr) continue;
    const std::string full_name = prefix_of(command) + name->value;
    has_sensor = true;
    if (is_on && !is_on(full_name)) continue;
    const SensorType* const found = find_sensor_type(type->value);
    if (found != nullptr && found->sees_shapes) return "sensor " + in_quotes(full_name);
  }
  return has_sensor ? std::nullopt : std::optional<std::string>("a scene without sensors");
}

SceneBuilder::SceneBuilder(BuiltScene& built, std::span<const AttributeOverride> overrides, std::uint64_t seed,
                           ProgressCallback progress)
    : built_(built), overrides_(overrides), seed_(seed), progress_(std::move(progress)) {
  Registrations::instance().require_none_refused();
  built_.scene.postpone_pictures();
  for (const AttributeOverride& override : overrides) check_override(override);
}

template <typename Action>
void SceneBuilder::all_or_nothing(const Action& action) {
  const std::uint64_t first_made = next_made_;
  try {
    action();
    check_awaited(first_made);
    warn_of_unmoved_sensors();
    if (check_) check_(built_);
    read_needed();
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

void SceneBuilder::read_needed() {
  for (const BuiltSensor& sensor : built_.sensors) {
    if (is_on_ && !is_on_(sensor.name)) continue;
    const SensorType& type = *find_sensor_type(sensor.type);
    const std::string needed_by = "sensor " + in_quotes(sensor.name);
    if (type.sees_shapes || sensor.sensor->needs().shapes) built_.scene.read_shapes(needed_by);
    const bool shows_colors = has_content(sensor.outputs, ImageContent::color) || !is_of_the_library(type);
    if (shows_colors) built_.scene.read_pictures(needed_by);
  }
}

void SceneBuilder::read_for_sensors() {
  try {
    read_needed();
  } catch (...) {
    built_.scene.undo().roll_back();
    throw;
  }
  built_.scene.undo().commit();
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

void SceneBuilder::require(std::function<const TargetLimits&()> limits) {
  limits_ = std::move(limits);
  for (const BuiltSensor& sensor : built_.sensors) {
    if (sensor.sensor->draws() && (!is_on_ || is_on_(sensor.name))) sensor.sensor->check(limits_());
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
  if (at == nullptr || built_.scene.objects().find(at->value)) return;
  if (built_.scene.objects().find(prefix_of(command) + at->value)) return;
  for (const Command& other : later) {
    const CommandAttribute* name = other.find("name");
    if (other.kind != CommandKind::part || name == nullptr || name->value != at->value) continue;
    if (prefix_of(other) != prefix_of(command)) continue;
    fail_at(at->where, "there is no insertion point " + in_quotes(at->value) + " yet: its part comes later, at " +
                           to_string(other.where) + ", and commands are executed in order");
  }
}

void SceneBuilder::execute_one(const Command& command) {
  if (command.kind == CommandKind::remove) return remove(command);
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
    const CommandKind kind = *referred_kind(spec.kind);
    Made::Reference reference{kind, attribute->name, attribute->value, {}, attribute->where};
    if (kind == CommandKind::part) {
      const ObjectTree& objects = built_.scene.objects();
      if (const auto found = objects.find(attribute->value)) reference.object = objects[*found].name;
    }
    made.references.push_back(std::move(reference));
  }
  if (command.kind == CommandKind::part) {
    const ObjectTree& objects = built_.scene.objects();
    made.points = objects.names_in(*objects.find(made.name));
  }
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

BuiltScene build_scene(std::span<const Command> commands, std::span<const AttributeOverride> overrides,
                       std::uint64_t seed) {
  BuiltScene built;
  SceneBuilder(built, overrides, seed).execute(commands);
  return built;
}

}  // namespace simvis
