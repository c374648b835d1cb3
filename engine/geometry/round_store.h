// The meshes of the round shapes of a draw list at the levels that views have asked for.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>

#include "engine/geometry/round_levels.h"

namespace simvis {

/// A level of a round shape that a view draws and that has no mesh yet.
struct LackingLevel {
  std::uint32_t mesh = 0;   ///< in DrawList::meshes
  std::uint32_t level = 0;  ///< in kRoundSides

  auto operator<=>(const LackingLevel&) const = default;
};

/// Meshes are identified by address. A level is made when a view first draws it, and released with its mesh.
class RoundStore {
 public:
  /// Releases the levels of meshes that are not among these.
  void keep_only(std::span<const std::shared_ptr<const Mesh>> meshes);

  /// Makes a level of a mesh, which has_round_levels().
  void make(const std::shared_ptr<const Mesh>& mesh, std::size_t level);

  using Levels = std::array<std::shared_ptr<const Mesh>, kRoundSides.size()>;

  /// The levels of a mesh, coarse to fine; null: not made.
  const Levels& levels_of(const std::shared_ptr<const Mesh>& mesh);

 private:
  struct Entry {
    std::shared_ptr<const Mesh> mesh;  // ownership prevents reuse of the address by another mesh
    Levels levels;
  };
  Entry& entry_of(const std::shared_ptr<const Mesh>& mesh);

  std::unordered_map<const Mesh*, Entry> entries_;
};

}  // namespace simvis
