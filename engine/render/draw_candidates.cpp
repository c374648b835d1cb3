#include "engine/render/draw_candidates.h"

#include <algorithm>

#include "engine/draw/round_mesh.h"
#include "engine/geometry/projected_error.h"

namespace simvis {
namespace {

void count_level(ViewDraws& draws, const DrawnLevel& drawn) {
  auto counted = std::ranges::lower_bound(draws.levels, drawn.level, {}, &DrawnLevel::level);
  if (counted == draws.levels.end() || counted->level != drawn.level) {
    counted = draws.levels.insert(counted, {.level = drawn.level});
  }
  counted->items += drawn.items;
  counted->exact_triangles += drawn.exact_triangles;
  counted->triangles += drawn.triangles;
  counted->error_px = std::max(counted->error_px, drawn.error_px);
}

// Counts what a view with a tolerance draws coarser than other views, or less finely than its tolerance requires.
void count_round(const ViewContext& context, const Drawable& d, const RoundLevel& chosen) {
  if (context.view.max_error_px <= 0) return;
  constexpr auto kExact = static_cast<std::size_t>(std::ranges::find(kRoundSides, kSidesAround) - kRoundSides.begin());
  if (chosen.number >= kExact && chosen.error_px < context.view.max_error_px) return;
  count_level(context.draws, {.level = static_cast<std::uint32_t>(kExact - std::min(chosen.number, kExact)),
                              .items = 1,
                              .exact_triangles = d.range.index_count / 3,
                              .triangles = d.round[chosen.number].index_count / 3,
                              .error_px = chosen.error_px});
}

// Replaces the tile by the coarsest of its levels whose error stays below the view's tolerance.
void choose_level(const ViewContext& context, const LevelledRange& tile, DrawCandidate& candidate) {
  const ProjectedError error(context.view, context.projection, *candidate.box, *candidate.world_from_mesh);
  for (std::size_t i = tile.levels.size(); i-- > 0;) {
    const LevelRange& level = tile.levels[i];
    const double error_px = error.px(level.error_m);
    if (error_px >= context.view.max_error_px) continue;
    candidate.range = &level.range;
    candidate.error_m = static_cast<float>(error.world_m(level.error_m));
    count_level(context.draws, {.level = static_cast<std::uint32_t>(i) + 1,
                                .items = 1,
                                .exact_triangles = tile.range.index_count / 3,
                                .triangles = level.range.index_count / 3,
                                .error_px = error_px});
    return;
  }
}

}  // namespace

void DrawCandidates::begin(const ViewContext& context) {
  seen_items_.clear();
  place_boxes_.clear();
  lacking_.clear();
  places_ = context.view.places;
  if (context.view.culled) {
    context.draws.counts.boxes_examined += context.cache.find_seen(context.projection, seen_items_);
  }
  if (!places_.empty()) take_places(context);
  ignored_ = context.view.ignored.get();
  if (ignored_ != nullptr) std::erase_if(seen_items_, [this](std::uint32_t item) { return ignores(item); });
}

bool DrawCandidates::ignores(std::uint32_t item) const {
  return ignored_ != nullptr && std::ranges::binary_search(*ignored_, item);
}

// Items that this view sees elsewhere are seen by their boxes there.
void DrawCandidates::take_places(const ViewContext& context) {
  std::erase_if(seen_items_, [&](std::uint32_t item) { return find_place(item) != places_.size(); });
  for (const ItemPlace& place : places_) {
    const Mesh& mesh = *context.list.meshes[context.list.items[place.item].mesh];
    const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max);
    place_boxes_.push_back(make_box(place.world_from_mesh, (low + high) * 0.5, (high - low) * 0.5));
    if (context.view.culled && !outside(context.projection, place_boxes_.back())) seen_items_.push_back(place.item);
  }
  context.draws.counts.boxes_examined += places_.size();
}

// The number of its entry in places_; their number if it has none.
std::size_t DrawCandidates::find_place(std::uint32_t item) const {
  const auto found = std::ranges::lower_bound(places_, item, {}, &ItemPlace::item);
  return found != places_.end() && found->item == item ? static_cast<std::size_t>(found - places_.begin())
                                                       : places_.size();
}

std::span<const DrawCandidate> DrawCandidates::select(const ViewContext& context, const RenderQueue& queue) {
  candidates_.clear();
  tile_boxes_.clear();
  find_positions(context, queue);
  for (std::size_t i = 0; i < positions_.size();) {
    const Drawable& d = queue[positions_[i]];
    if (!d.round.empty()) {
      i = add_round(context, queue, i);
      continue;
    }
    if (context.view.max_error_px > 0 && !d.tiles.empty()) {
      add_tiles(context, whole(context, d));
    } else {
      candidates_.push_back(whole(context, d));
    }
    ++i;
  }
  return candidates_;
}

void DrawCandidates::find_positions(const ViewContext& context, const RenderQueue& queue) {
  const View& view = context.view;
  positions_.clear();
  const auto take = [&](std::uint32_t position) {
    if (position == RenderQueue::kNone) return;
    if (view.sees_lines_and_points || queue[position].key.topology == Topology::triangles) {
      positions_.push_back(position);
    }
  };
  if (!view.culled) {
    for (std::uint32_t position = 0; position < queue.size(); ++position) {
      if (!ignores(queue[position].item)) take(position);
    }
    return;
  }
  for (const std::uint32_t item : seen_items_) take(queue.position(item));
  std::ranges::sort(positions_);
  context.draws.items_culled += (view.sees_lines_and_points ? queue.size() : queue.solids()) - positions_.size();
}

DrawCandidate DrawCandidates::whole(const ViewContext& context, const Drawable& d) const {
  const std::size_t place = places_.empty() ? 0 : find_place(d.item);
  const bool elsewhere = place != places_.size();
  return {.drawable = &d,
          .range = &d.range,
          .world_from_mesh = elsewhere ? &places_[place].world_from_mesh : &context.list.world_from_node[d.transform],
          .box = elsewhere ? &place_boxes_[place] : &context.cache.box(d.item),
          .error_m = d.error_m};
}

// Adds each tile at a level of its own. A mesh of one tile has the box of its item.
void DrawCandidates::add_tiles(const ViewContext& context, const DrawCandidate& whole) {
  const std::span<const LevelledRange> tiles = whole.drawable->tiles;
  for (const LevelledRange& tile : tiles) {
    DrawCandidate part = whole;
    part.range = &tile.range;
    part.error_m = 0;
    if (tiles.size() > 1) {
      const glm::dvec3 low(tile.range.bounds_min), high(tile.range.bounds_max);
      part.box = &tile_boxes_.emplace_back(make_box(*whole.world_from_mesh, (low + high) * 0.5, (high - low) * 0.5));
      if (context.view.culled && outside(context.projection, *part.box)) continue;
    }
    choose_level(context, tile, part);
    candidates_.push_back(part);
  }
}

// Adds the round shape at positions_[first] and those that follow it and may share draws with it, level by level.
// Returns the number of the first one that may not.
std::size_t DrawCandidates::add_round(const ViewContext& context, const RenderQueue& queue, std::size_t first) {
  const std::uint32_t group = queue[positions_[first]].group;
  std::size_t end = first;
  round_.clear();
  for (; end < positions_.size() && queue[positions_[end]].group == group; ++end) {
    const DrawCandidate shape = whole(context, queue[positions_[end]]);
    const Mesh& mesh = *context.list.meshes[context.list.items[shape.drawable->item].mesh];
    const ProjectedError error(context.view, context.projection, *shape.box, *shape.world_from_mesh);
    round_.push_back({choose_round_level(*mesh.surface, error, round_limit_px(context.view)), shape});
  }
  // A strip is one draw, whatever the levels, and takes its parts in the order of the queue.
  if (!context.strip) std::ranges::stable_sort(round_, {}, [](const RoundCandidate& c) { return c.level.number; });
  for (RoundCandidate& candidate : round_) {
    const Drawable& d = *candidate.whole.drawable;
    const MeshRange& range = d.round[candidate.level.number];
    if (range.index_count == 0) {
      lacking_.push_back({context.list.items[d.item].mesh, static_cast<std::uint32_t>(candidate.level.number)});
      continue;
    }
    count_round(context, d, candidate.level);
    candidate.whole.range = &range;
    candidate.whole.error_m = static_cast<float>(candidate.level.error_m);
    candidates_.push_back(candidate.whole);
  }
  return end;
}

}  // namespace simvis
