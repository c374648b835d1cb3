// The command `remove`: takes out what an earlier command made, with all that hangs on it.
#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <utility>

#include <simvis/attributes.h>
#include "engine/base/assert.h"
#include "scenegraph/language/command_attributes.h"
#include "scenegraph/language/row_names.h"
#include "simvis/scene_builder.h"

namespace simvis {
namespace {

constexpr auto kRemoveCommonAttributes = names_of(kRemoveCommonRows);

std::string noun(CommandKind kind, const std::string& name) {
  return std::string(to_string(kind)) + " " + in_quotes(name);
}

}  // namespace

void SceneBuilder::remove(const Command& command) {
  const std::set<std::uint64_t> doomed = hanging_on(find_made(command));
  refuse_referred(command, doomed);
  // What was made later may refer to what was made before.
  for (auto each = doomed.rbegin(); each != doomed.rend(); ++each) take_out(*each);
  removed_ = true;
}

std::uint64_t SceneBuilder::find_made(const Command& command) const {
  const CommandAttribute& name = command.require("name");
  for (const IncludeScope* scope = command.scope.get(); scope != nullptr; scope = scope->outer.get()) {
    if (const auto found = find_made(command, scope->prefix + name.value)) return *found;
  }
  if (const auto found = find_made(command, name.value)) return *found;
  if (command.find("kind") == nullptr && built_.scene.has_insertion_point(name.value)) {
    fail_at(name.where,
            in_quotes(name.value) + (name.value == built_.scene.root()->name
                                         ? " is always there, expected the name of a part, an element or a sensor"
                                         : " stands in the file of a part, expected the name of this part"));
  }
  std::vector<std::string_view> known;
  for (const auto& [id, made] : made_) known.push_back(made.name);
  fail_at(name.where, "there is nothing of the name " + in_quotes(name.value) + suggestion(name.value, known) +
                          " (expected the name of a part, an element or a sensor)");
}

std::optional<std::uint64_t> SceneBuilder::find_made(const Command& command, const std::string& name) const {
  const AttributeValues attributes(command, kRemoveRows, kRemoveCommonAttributes);
  std::optional<std::uint64_t> found;
  for (const auto& [id, made] : made_) {
    if (made.name != name) continue;
    if (attributes.is_set("kind") && attributes.choice("kind") != to_string(made.kind)) continue;
    if (found) {
      fail_at(command.require("name").where,
              in_quotes(name) + " is the name of " + std::string(to_string(made_.at(*found).kind)) + " and of " +
                  std::string(to_string(made.kind)) + ", expected the attribute \"kind\" to say which one");
    }
    found = id;
  }
  return found;
}

// What hangs on something was made after it.
std::set<std::uint64_t> SceneBuilder::hanging_on(std::uint64_t made) const {
  std::set<std::uint64_t> doomed{made};
  std::set<std::string_view> points;
  for (auto each = made_.find(made); each != made_.end(); ++each) {
    const Made& candidate = each->second;
    const bool carried = candidate.carrier && doomed.contains(*candidate.carrier);
    if (each->first != made && !carried && !points.contains(candidate.insert_at)) continue;
    doomed.insert(each->first);
    points.insert(candidate.points.begin(), candidate.points.end());
  }
  return doomed;
}

void SceneBuilder::refuse_referred(const Command& command, const std::set<std::uint64_t>& doomed) const {
  std::set<std::pair<CommandKind, std::string_view>> names;
  for (const std::uint64_t id : doomed) {
    const Made& made = made_.at(id);
    names.emplace(made.kind, made.name);
    for (const std::string& point : made.points) names.emplace(CommandKind::part, point);
  }
  for (const auto& [id, made] : made_) {
    if (doomed.contains(id)) continue;
    for (const Made::Reference& each : made.references) {
      const bool is_object = !each.object.empty();
      if (!names.contains({each.kind, is_object ? each.object : each.name})) continue;
      const ObjectTree& objects = built_.scene.objects();
      const std::string kind(is_object ? to_string(objects[*objects.find(each.object)].kind) : to_string(each.kind));
      fail_at(command.require("name").where, noun(made.kind, made.name) + " refers to " + kind + " " +
                                                 in_quotes(each.name) + " as its " + in_quotes(each.attribute) +
                                                 ", expected it to be removed before");
    }
  }
}

void SceneBuilder::take_out(std::uint64_t id) {
  UndoLog& undo = built_.scene.undo();
  const auto made = std::make_shared<Made>(std::move(made_.at(id)));
  made_.erase(id);
  undo.add_for_roll_back([this, id, made] { made_.emplace(id, std::move(*made)); });
  std::erase_if(inserted_, [&](const Inserted& each) { return each.kind == made->kind && each.name == made->name; });
  if (made->kind == CommandKind::element) take_out_element(made->name);
  if (made->kind == CommandKind::sensor) take_out_sensor(made->name);
  undo.take_back(made->steps);
  Command logged{.kind = CommandKind::remove, .attributes = {}, .where = {}, .folder = {}};
  logged.attributes = {{"name", made->name, {}}, {"kind", std::string(to_string(made->kind)), {}}};
  log_change(std::move(logged));
}

void SceneBuilder::take_out_element(const std::string& name) {
  Parameters& parameters = built_.parameters;
  const auto found = std::ranges::find_if(
      parameters.elements(), [&](const ElementDescriptor& each) { return !each.removed && each.name == name; });
  SIMVIS_ASSERT(found != parameters.elements().end());
  const auto i = static_cast<std::size_t>(found - parameters.elements().begin());
  const auto taken = std::make_shared<std::unique_ptr<Element>>(std::move(built_.elements[i]));
  parameters.mark_removed(i, true);
  // A roll-back runs this last: after the steps of the element have been made again.
  built_.scene.undo().add_for_roll_back([this, i, taken] {
    const ElementDescriptor& element = built_.parameters.elements()[i];
    built_.parameters.mark_removed(i, false);
    built_.elements[i] = std::move(*taken);
    built_.elements[i]->update(built_.parameters.values().subspan(element.first_value, element.parameters.size()));
  });
}

void SceneBuilder::take_out_sensor(const std::string& name) {
  const auto found = std::ranges::find(built_.sensors, name, &BuiltSensor::name);
  SIMVIS_ASSERT(found != built_.sensors.end());
  const auto i = found - built_.sensors.begin();
  const auto taken = std::make_shared<BuiltSensor>(std::move(*found));
  built_.sensors.erase(found);
  built_.scene.undo().add_for_roll_back(
      [this, i, taken] { built_.sensors.insert(built_.sensors.begin() + i, std::move(*taken)); });
}

}  // namespace simvis
