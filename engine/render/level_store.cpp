#include "engine/render/level_store.h"

#include <filesystem>

namespace simvis {

void LevelStore::update(std::span<const std::shared_ptr<const Mesh>> meshes) {
  // Only the first load uses the disk cache: later meshes may be new in each frame, as deforming meshes are.
  const std::filesystem::path cache = entries_.empty() ? device_.cache_folder : "";
  for (auto& [mesh, entry] : entries_) entry.used = false;
  std::uint64_t done = 0;
  for (const std::shared_ptr<const Mesh>& mesh : meshes) {
    device_.report({"preparing levels", done++, meshes.size()});
    if (mesh == nullptr) continue;
    const auto [found, added] = entries_.try_emplace(mesh.get());
    Entry& entry = found->second;
    entry.used = true;
    if (!added) continue;
    entry.mesh = mesh;
    entry.levels = make_levels(*mesh, cache, device_.threads.get());
  }
  std::erase_if(entries_, [](const auto& entry) { return !entry.second.used; });
}

std::span<const MeshLevel> LevelStore::levels_of(const Mesh* mesh) const {
  const auto found = entries_.find(mesh);
  return found == entries_.end() ? std::span<const MeshLevel>() : found->second.levels;
}

}  // namespace simvis
