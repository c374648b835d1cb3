// Items in the order in which a kind of pass draws them: by what the GPU would have to switch, and then by content.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include "engine/render/geometry_pool.h"
#include "engine/render/pipelines.h"

namespace simvis {

/// An item as one kind of pass draws it.
struct Drawable {
  PipelineKey key;  ///< `cull_back` and `mirrored` are settled by the view
  bool single_sided = false, mirrored = false;
  bool depth_visible = true;  ///< depth meets it, at least where it is most solid
  std::uint32_t item = 0, material = 0, transform = 0;
  std::uint32_t rank = 0;   ///< what has a lower one is drawn before; among equals their places decide
  std::uint32_t group = 0;  ///< one instanced draw can take neighbours of the same
  VkDescriptorSet texture = VK_NULL_HANDLE;
  MeshRange range;
};

/// Positions count from 0 in the order of drawing. Equal ranks at equal places are drawn in the order of their items.
class RenderQueue {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// Takes an item's drawables, in the order of the items, which are so many; sort() before anything else.
  void clear(std::size_t items);
  void add(const Drawable& drawable);
  std::span<Drawable> drawables() { return drawables_; }

  /// What moves may change places with others of its rank: all of them, or none but those of these items.
  void sort(const DrawList& list);
  void sort(const DrawList& list, std::span<const std::uint32_t> moved_items);

  std::size_t size() const { return drawables_.size(); }
  /// How many are made of triangles, and not of lines or points.
  std::size_t solids() const { return solids_; }
  const Drawable& operator[](std::uint32_t position) const { return drawables_[order_[position]]; }
  /// kNone for an item that such a pass does not draw.
  std::uint32_t position(std::uint32_t item) const { return position_[item]; }

 private:
  template <typename Less>
  void sort_among_rank(std::span<const std::uint32_t> moved, const Less& before);

  std::vector<Drawable> drawables_;      // in the order of the items
  std::vector<std::uint32_t> order_;     // numbers of drawables, by position
  std::vector<std::uint32_t> position_;  // by item
  std::size_t solids_ = 0;
};

}  // namespace simvis
