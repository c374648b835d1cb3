// First stage of a view's draws: the drawables within the view, each at the level of detail that the view shows.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "engine/geometry/round_levels.h"
#include "engine/render/view_context.h"

namespace simvis {

/// A drawable, or a tile of one, at the level that the view shows.
struct DrawCandidate {
  const Drawable* drawable = nullptr;
  const MeshRange* range = nullptr;  ///< what is drawn, in place of drawable->range
  const glm::dmat4* world_from_mesh = nullptr;
  const WorldBox* box = nullptr;  ///< holds the range
  float error_m = 0;              ///< of the range, as in Drawable
};

/// Keeps its memory from view to view.
class DrawCandidates {
 public:
  /// Starts a view. Finds the items within it if it is culled.
  void begin(const ViewContext& context);

  /// Returns the candidates of a queue in the order of drawing. Valid until the next call.
  std::span<const DrawCandidate> select(const ViewContext& context, const RenderQueue& queue);

  /// Levels of round shapes that the view needs and that the cache does not have, in any order; one may occur several
  /// times. The candidates are complete only if there are none.
  std::span<const LackingLevel> lacking() const { return lacking_; }

 private:
  struct RoundCandidate {
    RoundLevel level;
    DrawCandidate whole;
  };

  void take_places(const ViewContext& context);
  std::size_t find_place(std::uint32_t item) const;
  bool ignores(std::uint32_t item) const;
  void find_positions(const ViewContext& context, const RenderQueue& queue);
  DrawCandidate whole(const ViewContext& context, const Drawable& d) const;
  void add_tiles(const ViewContext& context, const DrawCandidate& whole);
  std::size_t add_round(const ViewContext& context, const RenderQueue& queue, std::size_t first);

  std::span<const ItemPlace> places_;                    // of the view
  const std::vector<std::uint32_t>* ignored_ = nullptr;  // by the view; null: none
  std::vector<WorldBox> place_boxes_;                    // of places_
  std::vector<std::uint32_t> seen_items_;                // used if the view is culled
  std::vector<std::uint32_t> positions_;                 // of the drawables in the queue, ascending
  std::vector<RoundCandidate> round_;                    // neighbours in the queue that may share draws
  std::deque<WorldBox> tile_boxes_;                      // candidates point to them
  std::vector<DrawCandidate> candidates_;
  std::vector<LackingLevel> lacking_;
};

}  // namespace simvis
