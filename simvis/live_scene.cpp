#include "simvis/live_scene.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "scenegraph/clone_graph.h"
#include "simvis/default_light.h"

namespace simvis {
namespace {

std::string origin_of(const AttributeOverride& override) {
  return override.origin.empty() ? override.sensor_type + "." + override.attribute : override.origin;
}

void check(const AttributeOverride& override) {
  const SensorType* const type = find_sensor_type(override.sensor_type);
  if (type == nullptr) return;  // the builder reports unknown types and lists the known ones
  const Location where{.file = origin_of(override)};
  Command command{.kind = CommandKind::sensor, .attributes = {}, .where = where, .folder = {}};
  if (override.value) command.attributes.push_back({override.attribute, *override.value, where});
  AttributeValues values(command, all_attributes(*type), {});
}

bool is_allowed(const AttributeOverride& override) {
  try {
    check(override);
  } catch (const InputError&) {
    return false;
  }
  return true;
}

// An invalid override is an error even if the scene has no sensor of the type. One option of the command line overrides
// several types: one of them must take the value, and, as the builder checks, all that are in the scene.
std::vector<AttributeOverride> checked(std::vector<AttributeOverride> overrides) {
  for (const AttributeOverride& each : overrides) {
    const auto serves = [&](const AttributeOverride& other) {
      return other.attribute == each.attribute && origin_of(other) == origin_of(each) && is_allowed(other);
    };
    if (std::ranges::none_of(overrides, serves)) check(each);
  }
  return overrides;
}

std::vector<PackageFolder> checked(std::vector<PackageFolder> packages) {
  for (const PackageFolder& package : packages) {
    std::error_code error;
    if (package.name.empty()) throw InputError("a package has no name, expected NAME=DIR");
    if (!std::filesystem::is_directory(package.folder, error)) {
      throw InputError("package " + in_quotes(package.name) + ": there is no folder " +
                       in_quotes(package.folder.string()));
    }
  }
  return packages;
}

}  // namespace

LiveScene::LiveScene(std::vector<AttributeOverride> overrides, std::span<const Command> commands, std::uint64_t seed,
                     ProgressCallback progress, std::vector<PackageFolder> packages, bool strict, SensorSelection is_on)
    : overrides_(checked(std::move(overrides))),
      builder_(built, overrides_, seed, std::move(progress)),
      default_light_(std::make_shared<Switch>()) {
  built.scene.set_packages(checked(std::move(packages)));
  default_light_->add(std::make_shared<LightNode>(kDefaultLight));
  built.scene.insert_in_world(default_light_);
  built.scene.undo().commit();
  if (strict) built.scene.make_strict();
  const std::optional<std::string> need = is_on && !strict ? need_of_shapes(commands, is_on) : "all that is read";
  need ? built.scene.note_need_of_shapes(*need) : built.scene.postpone_shapes();
  builder_.select(std::move(is_on));
  execute(commands);
}

void LiveScene::execute(std::span<const Command> commands) {
  builder_.execute(commands);
  default_light_->set_which(declares_light() ? Switch::kNone : Switch::kAll);
}

// Whether the scene declares a light itself, even if a switch currently hides it.
bool LiveScene::declares_light() const {
  const Node* const own = default_light_->children().front().get();
  return std::ranges::any_of(nodes_of(built.scene.root()), [own](const NodePtr& node) {
    return node->kind() == NodeKind::light && node.get() != own;
  });
}

}  // namespace simvis
