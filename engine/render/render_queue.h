// Items in the order in which one kind of pass draws them: sorted by GPU state, then by content.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include "engine/render/geometry_pool.h"
#include "engine/render/pipelines.h"

namespace simvis {

/// A coarser level of a mesh on the device.
struct LevelRange {
  double error_m = 0;  ///< in the mesh's frame, see MeshLevel
  MeshRange range;
};

/// A mesh, or a tile of a large one, with its coarser levels.
struct LevelledRange {
  MeshRange range;
  std::span<const LevelRange> levels{};  ///< finer ones first
};

/// An item as one kind of pass draws it.
struct Drawable {
  PipelineKey key;  ///< the view sets `cull_back` and `mirrored`
  bool single_sided = false, mirrored = false;
  bool depth_visible = true;  ///< visible to depth, at least where its alpha is largest
  std::uint32_t item = 0, material = 0, transform = 0;
  std::uint32_t rank = 0;   ///< lower ranks are drawn first; the transforms decide between equal ranks
  std::uint32_t group = 0;  ///< neighbours with the same group can share one instanced draw
  VkDescriptorSet texture = VK_NULL_HANDLE;
  float point_m = 0;  ///< size of the squares of points in the frame of their mesh; 0: a pixel each
  MeshRange range;
  std::span<const LevelledRange> tiles{};  ///< what `range` consists of; empty in queues for depth, and without levels
  /// Of a round shape: its levels, coarse to fine, see round_levels.h. Those that were not made have no indices.
  std::span<const MeshRange> round{};
  float error_m = 0;  ///< bound on the distance of what `range` shows from the surface, in the world
};

/// Positions count from 0 in the order of drawing. Drawables with equal ranks and equal transforms are drawn in the
/// order of their items.
class RenderQueue {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// clear() starts a queue for `items` items; add() appends drawables in the order of the items. Call sort() before
  /// any other function.
  void clear(std::size_t items);
  void add(const Drawable& drawable);
  std::span<Drawable> drawables() { return drawables_; }

  /// Sorts again after items have moved, which can change the order within a rank. Without `moved_items`, all items may
  /// have moved.
  void sort(const DrawList& list);
  void sort(const DrawList& list, std::span<const std::uint32_t> moved_items);

  std::size_t size() const { return drawables_.size(); }
  /// Number of drawables made of triangles, not of lines or points.
  std::size_t solids() const { return solids_; }
  const Drawable& operator[](std::uint32_t position) const { return drawables_[order_[position]]; }
  /// kNone for an item that this kind of pass does not draw.
  std::uint32_t position(std::uint32_t item) const { return position_[item]; }

 private:
  template <typename Less>
  void sort_among_rank(std::span<const std::uint32_t> moved, const Less& before);

  std::vector<Drawable> drawables_;      // in the order of the items
  std::vector<std::uint32_t> order_;     // numbers of drawables, by position
  std::vector<std::uint32_t> position_;  // position by item
  std::size_t solids_ = 0;
};

}  // namespace simvis
