#include "engine/render/level_store.h"

#include <algorithm>
#include <atomic>
#include <filesystem>

#include "engine/base/thread_pool.h"

namespace simvis {

void LevelStore::update(std::span<const std::shared_ptr<const Mesh>> meshes) {
  // Only the first load uses the disk cache: later meshes may be new in each frame, as deforming meshes are.
  const std::filesystem::path cache = entries_.empty() ? device_.cache_folder : "";
  for (auto& [mesh, entry] : entries_) entry.used = false;
  std::vector<Entry*> added;
  for (const std::shared_ptr<const Mesh>& mesh : meshes) {
    if (mesh == nullptr) continue;
    const auto [found, is_new] = entries_.try_emplace(mesh.get());
    found->second.used = true;
    if (!is_new) continue;
    found->second.mesh = mesh;
    added.push_back(&found->second);
  }
  std::atomic<std::uint64_t> done = 0;
  device_.threads->parallel_for(added.size(), 1, [&](std::size_t slot, std::size_t first, std::size_t count) {
    for (Entry* const entry : std::span(added).subspan(first, count)) {
      if (slot == 0) device_.report({"preparing levels", done, added.size()});  // in the caller's thread alone
      entry->tiles = make_levelled_tiles(entry->mesh, cache, device_.threads.get());
      if (std::ranges::all_of(entry->tiles, [](const LevelledTile& tile) { return tile.levels.empty(); })) {
        entry->tiles.clear();
      }
      ++done;
    }
  });
  std::erase_if(entries_, [](const auto& entry) { return !entry.second.used; });
}

std::span<const LevelledTile> LevelStore::tiles_of(const Mesh* mesh) const {
  const auto found = entries_.find(mesh);
  return found == entries_.end() ? std::span<const LevelledTile>() : found->second.tiles;
}

}  // namespace simvis
