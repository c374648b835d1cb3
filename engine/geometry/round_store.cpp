#include "engine/geometry/round_store.h"

#include <unordered_set>

#include "engine/draw/round_mesh.h"

namespace simvis {

void RoundStore::keep_only(std::span<const std::shared_ptr<const Mesh>> meshes) {
  if (entries_.empty()) return;
  std::unordered_set<const Mesh*> kept;
  for (const std::shared_ptr<const Mesh>& mesh : meshes) kept.insert(mesh.get());
  std::erase_if(entries_, [&](const auto& entry) { return !kept.contains(entry.first); });
}

// A mesh that round_mesh() made is one of its own levels.
RoundStore::Entry& RoundStore::entry_of(const std::shared_ptr<const Mesh>& mesh) {
  const auto [found, is_new] = entries_.try_emplace(mesh.get());
  if (!is_new) return found->second;
  found->second.mesh = mesh;
  for (std::size_t level = 0; level < round_levels_of(*mesh->surface); ++level) {
    const double at_radius_1 = deviation_at_radius_1(mesh->surface->kind, kRoundSides[level]);
    if (mesh->surface->deviation_m == deviation_of_round_mesh(*mesh->surface, at_radius_1)) {
      found->second.levels[level] = mesh;
    }
  }
  return found->second;
}

void RoundStore::make(const std::shared_ptr<const Mesh>& mesh, std::size_t level) {
  std::shared_ptr<const Mesh>& made = entry_of(mesh).levels[level];
  if (made == nullptr) made = std::make_shared<const Mesh>(round_mesh(*mesh->surface, kRoundSides[level]));
}

const RoundStore::Levels& RoundStore::levels_of(const std::shared_ptr<const Mesh>& mesh) {
  return entry_of(mesh).levels;
}

}  // namespace simvis
