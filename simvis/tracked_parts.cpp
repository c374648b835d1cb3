#include "simvis/tracked_parts.h"

#include <optional>
#include <set>
#include <utility>

#include <simvis/error.h>
#include <simvis/location.h>
#include "scenegraph/clone_graph.h"
#include "simvis/mount_frame.h"

namespace simvis {
namespace {

// Null: there is no object of this name or path.
std::shared_ptr<Mount> add_mount(std::string_view part, Scene& scene) {
  const std::optional<std::uint32_t> object = scene.objects().find(part);
  if (!object) return nullptr;
  const auto mount = std::make_shared<Mount>();
  mount->name = part;
  scene.insert_behind_point(scene.objects()[*object].name, mount);
  scene.undo().commit();
  return mount;
}

}  // namespace

void TrackedParts::track(std::string_view part, Scene& scene) {
  if (mounts_.contains(part)) return;
  std::shared_ptr<Mount> mount = add_mount(part, scene);
  if (mount == nullptr) throw InputError(scene.objects().unknown("part or link", part));
  mounts_.emplace(part, std::move(mount));
}

void TrackedParts::follow(Scene& scene) {
  if (mounts_.empty()) return;
  const std::vector<NodePtr> nodes = nodes_of(scene.root());
  const std::set<NodePtr> there(nodes.begin(), nodes.end());
  for (auto& [part, mount] : mounts_) {
    if (there.contains(mount)) continue;
    mount = add_mount(part, scene);
  }
}

bool TrackedParts::pose(std::string_view part, const Flattener& flattener, glm::dmat4& world_from_part) const {
  const auto found = mounts_.find(part);
  if (found == mounts_.end()) {
    throw InputError("part \"" + std::string(part) + "\" is not tracked, expected track_part() before");
  }
  glm::dmat4 world_from_mount;
  return found->second != nullptr && flattener.find_mount(*found->second, world_from_mount) &&
         rigid_mount_frame(world_from_mount, world_from_part);
}

}  // namespace simvis
