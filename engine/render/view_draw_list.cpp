#include "engine/render/view_draw_list.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/draw/light_block.h"
#include "engine/draw/round_mesh.h"
#include "engine/geometry/projected_error.h"

namespace simvis {
namespace {

using Surface = PipelineKey::Surface;

// The number of triangles whose drawing costs about as much as occlusion culling.
constexpr std::uint64_t kWorthHiding = 2000;

// Rasterisation moves what is drawn by less than this, and samples lie within their pixel.
constexpr double kMargin_px = 2;

// Along one axis of the picture: the pixels of points whose coordinate and depth are in these ranges.
void grow(double& low, double& high, double focal_px, double center_px, const glm::dvec2& coordinate,
          const glm::dvec2& depth) {
  for (const double x : {coordinate[0], coordinate[1]}) {
    for (const double z : {depth[0], depth[1]}) {
      low = std::min(low, focal_px * x / z + center_px);
      high = std::max(high, focal_px * x / z + center_px);
    }
  }
}

// The pixels that the content of the boxes may cover.
PixelRect pixels_of(std::span<const ViewBox> boxes, const View& view) {
  const glm::uvec2 size(view.width_px, view.height_px);
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const ViewBox& box : boxes) {
    const glm::dvec3 first = box.center - box.half_size - box.slack_m, last = box.center + box.half_size + box.slack_m;
    if (!view.orthographic && first.z <= view.near_m) return {{0, 0}, size};
    const glm::dvec2 depth = view.orthographic ? glm::dvec2(1) : glm::dvec2(first.z, last.z);
    grow(low.x, high.x, view.pinhole.fx_px, view.pinhole.cx_px, {first.x, last.x}, depth);
    grow(low.y, high.y, view.pinhole.fy_px, view.pinhole.cy_px, {first.y, last.y}, depth);
  }
  if (!(low.x <= high.x && low.y <= high.y)) return {{0, 0}, size};  // not numbers
  const glm::dvec2 limit(size);
  return {glm::uvec2(glm::clamp(glm::floor(low - kMargin_px), glm::dvec2(0), limit)),
          glm::uvec2(glm::clamp(glm::ceil(high + kMargin_px), glm::dvec2(0), limit))};
}

}  // namespace

bool is_strip(const View& view) { return view.culled && guard_rows(view) > 0; }

bool cpu_selects_points(const View& view, const Pass& pass) {
  return view.culled && !is_strip(view) && !view.orthographic && !pass.shadow_maps && pass.msaa == 1;
}

bool cpu_selects_opaque(const View& view) { return is_strip(view) && view.sees_back_faces; }

void ViewDrawList::update(const View& view, const Pass& pass, const StripColumns* columns, const DrawList& list,
                          const DrawCache& table, ColumnOcclusionBuffer& strip) {
  const ViewProjection projection = make_projection(view);
  draws_ = {};
  ++views_;
  runs_.clear();
  instances_.clear();
  items_.clear();
  names_items_ = pass.items;
  lights_.clear();
  indices_.clear();
  cpu_selected_.clear();
  point_positions_.clear();
  point_attributes_.clear();
  seen_items_.clear();
  lacking_.clear();
  items_culled_ = 0;
  draws_.block.projection =
      glm::vec4(glm::dvec4(projection.scale_x, projection.shift_x, projection.scale_y, projection.shift_y));
  draws_.block.ambient = glm::vec4(list.environment.ambient, static_cast<float>(view.near_m));
  draws_.block.airlight = glm::vec4(list.medium.airlight, static_cast<float>(list.medium.extinction_per_m));
  strip_ = columns != nullptr ? &strip : nullptr;
  if (strip_) strip_->begin(view, *columns);
  if (pass.color && table.any_lit()) add_lights(view, projection, list, table);
  if (view.culled) draws_.counts.boxes_examined += table.find_seen(projection, seen_items_);
  take_places(view, projection, list);
  limit_ = FacingTolerance(view, raster_.snap_px);
  hidden_.begin(view, limit_);
  selecting_ = raster_.selects_primitives && !strip_ && !view.orthographic && !pass.shadow_maps;
  if (selecting_) selector_.begin(view, pass.supersampling * pass.msaa, raster_.snap_px);
  selecting_points_ = raster_.selects_primitives && cpu_selects_points(view, pass);
  if (selecting_points_) point_selector_.begin(view, pass.supersampling, raster_.snap_px, raster_.points);
  if (view.culled && !strip_ && !view.orthographic && !pass.shadow_maps) {
    find_occluders(pass.color ? table.solid() : table.depth(), view, projection, list, table);
  }
  add_items(pass.color ? table.solid() : table.depth(), view, projection, list, table);
  draws_.first_layer = runs_.size();
  if (pass.color) {
    add_items(table.blended(), view, projection, list, table);
    draws_.layered = layered_pixels(table.blended(), view, projection, table);
  }
  draws_.first_depth_visible = runs_.size();
  if (pass.depth) add_depth_visible(draws_.first_layer, draws_.first_depth_visible);
  draws_.end_run = runs_.size();
  for (DrawRun& run : runs_) {
    run.key.shadow_map = pass.shadow_maps;
    run.key.orthographic = view.orthographic;
    run.key.items = pass.items && (run.key.depth_only || !run.key.blends());
    draws_.counts.triangles += run.triangles();
    if (run.key.surface == Surface::masked) draws_.counts.masked_triangles += run.triangles();
  }
  draws_.counts.draws = runs_.size();
}

// Items that this view sees elsewhere are seen by their boxes there.
void ViewDrawList::take_places(const View& view, const ViewProjection& projection, const DrawList& list) {
  places_ = view.places;
  place_boxes_.clear();
  if (places_.empty()) return;
  std::erase_if(seen_items_, [&](std::uint32_t item) { return find_place(item) != places_.size(); });
  for (const ItemPlace& place : places_) {
    const Mesh& mesh = *list.meshes[list.items[place.item].mesh];
    const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max);
    place_boxes_.push_back(make_box(place.world_from_mesh, (low + high) * 0.5, (high - low) * 0.5));
    if (view.culled && !outside(projection, place_boxes_.back())) seen_items_.push_back(place.item);
  }
  draws_.counts.boxes_examined += places_.size();
}

// The number of its entry in places_; their number if it has none.
std::size_t ViewDrawList::find_place(std::uint32_t item) const {
  const auto found = std::ranges::lower_bound(places_, item, {}, &ItemPlace::item);
  return found != places_.end() && found->item == item ? static_cast<std::size_t>(found - places_.begin())
                                                       : places_.size();
}

const glm::dmat4& ViewDrawList::place_of(const Drawable& d, const DrawList& list) const {
  const std::size_t place = places_.empty() ? 0 : find_place(d.item);
  return place == places_.size() ? list.world_from_node[d.transform] : places_[place].world_from_mesh;
}

const WorldBox& ViewDrawList::box_of(std::uint32_t item, const DrawCache& table) const {
  const std::size_t place = places_.empty() ? 0 : find_place(item);
  return place == places_.size() ? table.box(item) : place_boxes_[place];
}

void ViewDrawList::append_visible(const RenderQueue& items, const View& view) {
  positions_.clear();
  const auto take = [&](std::uint32_t position) {
    if (position == RenderQueue::kNone) return;
    if (view.sees_lines_and_points || items[position].key.topology == Topology::triangles) {
      positions_.push_back(position);
    }
  };
  if (!view.culled) {
    for (std::uint32_t position = 0; position < items.size(); ++position) take(position);
    return;
  }
  for (const std::uint32_t item : seen_items_) take(items.position(item));
  std::ranges::sort(positions_);
  items_culled_ += (view.sees_lines_and_points ? items.size() : items.solids()) - positions_.size();
}

void ViewDrawList::add_items(const RenderQueue& items, const View& view, const ViewProjection& projection,
                             const DrawList& list, const DrawCache& table) {
  const std::size_t first_run = runs_.size();
  append_visible(items, view);
  strip_round_.clear();
  for (std::size_t i = 0; i < positions_.size();) {
    const std::uint32_t position = positions_[i];
    const Drawable& d = items[position];
    if (!d.round.empty()) {
      i = add_round(items, i, view, projection, list, table, first_run);
      continue;
    }
    if (view.max_error_px > 0 && !d.tiles.empty()) {
      add_tiles(d, position, view, projection, list, table, first_run);
    } else {
      add_item(d, position, view, projection, list, box_of(d.item, table), first_run);
    }
    ++i;
  }
  if (strip_) draw_strip(items, view, projection, list);
}

// Draws each tile at a level of its own.
void ViewDrawList::add_tiles(const Drawable& d, std::uint32_t position, const View& view,
                             const ViewProjection& projection, const DrawList& list, const DrawCache& table,
                             std::size_t first_run) {
  Drawable part = d;
  for (std::size_t tile = 0; tile < d.tiles.size(); ++tile) {
    const WorldBox box = box_of(d, tile, list, table);
    if (view.culled && d.tiles.size() > 1 && outside(projection, box)) continue;
    const ChosenLevel chosen = choose_level(d, tile, view, projection, list, table);
    if (chosen.level != nullptr) count_level(d.tiles[tile], chosen);
    part.range = chosen.level != nullptr ? chosen.level->range : d.tiles[tile].range;
    part.error_m = chosen.error_m;
    add_item(part, position, view, projection, list, box, first_run);
  }
}

// Draws the round shape at positions_[first] and those that follow it and may share draws with it, level by level.
// Returns the number of the first one that may not.
std::size_t ViewDrawList::add_round(const RenderQueue& items, std::size_t first, const View& view,
                                    const ViewProjection& projection, const DrawList& list, const DrawCache& table,
                                    std::size_t first_run) {
  const std::uint32_t group = items[positions_[first]].group;
  std::size_t end = first;
  round_.clear();
  for (; end < positions_.size() && items[positions_[end]].group == group; ++end) {
    round_.push_back({choose_round(items[positions_[end]], view, projection, list, table), positions_[end]});
  }
  // A strip is one draw, whatever the levels, and takes its parts in the order of the queue.
  if (!strip_) std::ranges::stable_sort(round_, {}, [](const RoundItem& item) { return item.level.number; });
  for (const RoundItem& item : round_) {
    Drawable part = items[item.position];
    const MeshRange* const range = round_range(part, item.level, list);
    if (range == nullptr) continue;
    count_round(part, item.level, view);
    part.range = *range;
    part.error_m = static_cast<float>(item.level.error_m);
    if (strip_) strip_round_.push_back({item.position, range->positions});
    add_item(part, item.position, view, projection, list, box_of(part.item, table), first_run);
  }
  return end;
}

RoundLevel ViewDrawList::choose_round(const Drawable& d, const View& view, const ViewProjection& projection,
                                      const DrawList& list, const DrawCache& table) {
  const ProjectedError error(view, projection, box_of(d.item, table), place_of(d, list));
  return choose_round_level(*list.meshes[list.items[d.item].mesh]->surface, error, round_limit_px(view));
}

// Null: the level was not made, which is noted.
const MeshRange* ViewDrawList::round_range(const Drawable& d, const RoundLevel& level, const DrawList& list) {
  const MeshRange& range = d.round[level.number];
  if (range.index_count > 0) return &range;
  lacking_.push_back({list.items[d.item].mesh, static_cast<std::uint32_t>(level.number)});
  return nullptr;
}

// Counts what a view with a dial draws coarser than other views, or not as fine as its dial says.
void ViewDrawList::count_round(const Drawable& d, const RoundLevel& chosen, const View& view) {
  if (view.max_error_px <= 0) return;
  constexpr auto kExact = static_cast<std::size_t>(std::ranges::find(kRoundSides, kSidesAround) - kRoundSides.begin());
  if (chosen.number >= kExact && chosen.error_px < view.max_error_px) return;
  DrawnLevel& counted = counted_level(static_cast<std::uint32_t>(kExact - std::min(chosen.number, kExact)));
  ++counted.items;
  counted.exact_triangles += d.range.index_count / 3;
  counted.triangles += d.round[chosen.number].index_count / 3;
  counted.error_px = std::max(counted.error_px, chosen.error_px);
}

void ViewDrawList::add_item(const Drawable& d, std::uint32_t position, const View& view,
                            const ViewProjection& projection, const DrawList& list, const WorldBox& box,
                            std::size_t first_run) {
  const bool strip = strip_ != nullptr;
  if (strip && can_cpu_select(d, view)) {
    add_to_strip(d, position, projection, list, box);
  } else if (is_hidden(d, projection, list, box)) {
    ++items_culled_;
  } else if (can_select_points(d)) {
    draw_selected_points(d, view, projection, list, box);
  } else if (!view.culled || d.range.clusters.size() == 1) {
    draw(d, view, projection, list, first_run);
  } else if (strip) {
    draw_seen_triangles(d, view, projection, list, box);
  } else {
    draw_seen_clusters(d, view, projection, list, box, first_run);
  }
}

// The coarsest level of a tile whose error stays below that of the view; null: the tile itself. Occluders and draws of
// an item ask for the same level.
ViewDrawList::ChosenLevel ViewDrawList::choose_level(const Drawable& d, std::size_t tile, const View& view,
                                                     const ViewProjection& projection, const DrawList& list,
                                                     const DrawCache& table) {
  if (chosen_.size() < table.item_tiles()) chosen_.resize(table.item_tiles());
  ChosenLevel& chosen = chosen_[d.first_tile + tile];
  if (chosen.view == views_) return chosen;
  chosen = {.view = views_};
  const ProjectedError error(view, projection, box_of(d, tile, list, table), place_of(d, list));
  const std::span<const LevelRange> levels = d.tiles[tile].levels;
  for (std::size_t i = levels.size(); i-- > 0;) {
    const double error_px = error.px(levels[i].error_m);
    if (error_px >= view.max_error_px) continue;
    chosen.level = &levels[i];
    chosen.error_px = error_px;
    chosen.error_m = static_cast<float>(error.world_m(levels[i].error_m));
    break;
  }
  return chosen;
}

// A mesh of one tile has the box of its item.
WorldBox ViewDrawList::box_of(const Drawable& d, std::size_t tile, const DrawList& list, const DrawCache& table) const {
  if (d.tiles.size() == 1) return box_of(d.item, table);
  const glm::dvec3 low(d.tiles[tile].range.bounds_min), high(d.tiles[tile].range.bounds_max);
  return make_box(place_of(d, list), (low + high) * 0.5, (high - low) * 0.5);
}

void ViewDrawList::count_level(const LevelledRange& tile, const ChosenLevel& chosen) {
  DrawnLevel& counted = counted_level(static_cast<std::uint32_t>(chosen.level - tile.levels.data()) + 1);
  ++counted.items;
  counted.exact_triangles += tile.range.index_count / 3;
  counted.triangles += chosen.level->range.index_count / 3;
  counted.error_px = std::max(counted.error_px, chosen.error_px);
}

DrawnLevel& ViewDrawList::counted_level(std::uint32_t number) {
  auto counted = std::ranges::lower_bound(draws_.levels, number, {}, &DrawnLevel::level);
  if (counted == draws_.levels.end() || counted->level != number) {
    counted = draws_.levels.insert(counted, {.level = number});
  }
  return *counted;
}

// Adds occluders only if the view has enough triangles for occlusion culling to pay off.
void ViewDrawList::find_occluders(const RenderQueue& items, const View& view, const ViewProjection& projection,
                                  const DrawList& list, const DrawCache& table) {
  std::uint64_t triangles = 0;
  for (const std::uint32_t item : seen_items_) {
    const std::uint32_t position = items.position(item);
    if (position != RenderQueue::kNone) triangles += items[position].range.index_count / 3;
  }
  if (triangles < kWorthHiding) return;
  for (const std::uint32_t item : seen_items_) {
    const std::uint32_t position = items.position(item);
    if (position == RenderQueue::kNone) continue;
    const Drawable& d = items[position];
    if (d.range.occluders.empty() || d.key.surface != Surface::opaque) continue;
    if (!d.round.empty()) {
      const ViewBox box = view_box(projection, box_of(item, table));
      if (!hidden_.may_hold_occluders(box)) continue;
      const MeshRange* const drawn = round_range(d, choose_round(d, view, projection, list, table), list);
      if (drawn != nullptr) add_occluders(d, *drawn, box, view, projection, list);
    } else if (view.max_error_px > 0 && !d.tiles.empty()) {
      for (std::size_t tile = 0; tile < d.tiles.size(); ++tile) {
        const ViewBox box = view_box(projection, box_of(d, tile, list, table));
        if (!hidden_.may_hold_occluders(box)) continue;
        const ChosenLevel chosen = choose_level(d, tile, view, projection, list, table);
        add_occluders(d, chosen.level != nullptr ? chosen.level->range : d.tiles[tile].range, box, view, projection,
                      list);
      }
    } else if (const ViewBox box = view_box(projection, box_of(item, table)); hidden_.may_hold_occluders(box)) {
      add_occluders(d, d.range, box, view, projection, list);
    }
  }
}

void ViewDrawList::add_occluders(const Drawable& d, const MeshRange& drawn, const ViewBox& box, const View& view,
                                 const ViewProjection& projection, const DrawList& list) {
  hidden_.add(drawn.occluders, projection.view_from_world * place_of(d, list), box.slack_m,
              d.single_sided && !view.sees_back_faces, d.mirrored);
}

bool ViewDrawList::is_hidden(const Drawable& d, const ViewProjection& projection, const DrawList& list,
                             const WorldBox& box) const {
  return hidden_.any() && d.key.topology == Topology::triangles &&
         hidden_.is_occluded(view_box(projection, box), projection.view_from_world * place_of(d, list), d.range);
}

void ViewDrawList::add_lights(const View& view, const ViewProjection& projection, const DrawList& list,
                              const DrawCache& table) {
  for (const std::uint32_t light : table.lights()) {
    const LightItem& item = list.lights[light];
    lights_.push_back(make_light_block(item.light, projection.view_from_world * list.world_from_node[item.transform]));
  }
  for (std::size_t i = 0; i < view.shadows.size(); ++i) {
    const auto place = std::ranges::find(table.lights(), view.shadows[i].light) - table.lights().begin();
    lights_[static_cast<std::size_t>(place)].shadow.x = static_cast<float>(i + 1);
  }
}

void ViewDrawList::draw(const Drawable& d, const View& view, const ViewProjection& projection, const DrawList& list,
                        std::size_t first_run) {
  const std::uint32_t instance = add_instance(d, projection, list);
  if (runs_.size() > first_run && d.group == last_group_ && d.range.first_index == runs_.back().range.first_index) {
    ++runs_.back().instance_count;
    return;
  }
  last_group_ = d.group;
  add_run(d, key_in_view(d, view, list), d.range, instance);
}

PipelineKey ViewDrawList::key_in_view(const Drawable& d, const View& view, const DrawList& list) {
  PipelineKey key = d.key;
  key.shadowed = key.lights.any() && !view.shadows.empty();
  key.fog = key.color && list.medium.extinction_per_m > 0;
  if (key.topology != Topology::triangles) return key;
  key.cull_back = d.single_sided && !view.sees_back_faces;
  key.mirrored = d.mirrored && (key.cull_back || key.lights.any());
  return key;
}

// Adds a draw of one instance.
DrawRun& ViewDrawList::add_run(const Drawable& d, const PipelineKey& key, const MeshRange& range,
                               std::uint32_t instance) {
  return runs_.emplace_back(DrawRun{.key = key,
                                    .texture = d.texture,
                                    .range = range,
                                    .first_instance = instance,
                                    .instance_count = 1,
                                    .depth_visible = d.depth_visible,
                                    .point_m = d.point_m});
}

std::uint32_t ViewDrawList::add_instance(const Drawable& d, const ViewProjection& projection, const DrawList& list) {
  shader::Instance& instance = instances_.emplace_back();
  write_clip_rows(projection, place_of(d, list), instance);
  instance.material = d.material;
  instance.error_m = d.error_m;
  if (names_items_) items_.push_back(d.item);
  return static_cast<std::uint32_t>(instances_.size() - 1);
}

// `items` are those of the last append_visible(). Lines and points are wider than their places, so they count as
// everywhere.
PixelRect ViewDrawList::layered_pixels(const RenderQueue& items, const View& view, const ViewProjection& projection,
                                       const DrawCache& table) const {
  std::vector<ViewBox> boxes;
  for (const std::uint32_t position : positions_) {
    const Drawable& d = items[position];
    if (d.key.topology != Topology::triangles) return {{0, 0}, {view.width_px, view.height_px}};
    boxes.push_back(view_box(projection, box_of(d.item, table)));
  }
  return boxes.empty() ? PixelRect{} : pixels_of(boxes, view);
}

// Adds the transparent runs that are depth-visible a second time, for depth.
void ViewDrawList::add_depth_visible(std::size_t first_layer, std::size_t end_layer) {
  for (std::size_t i = first_layer; i < end_layer; ++i) {
    DrawRun run = runs_[i];
    if (!run.depth_visible) continue;
    const PipelineKey layer = run.key;
    run.key = {.color = true,
               .topology = layer.topology,
               .surface = Surface::masked,
               .textured = layer.textured,
               .cull_back = layer.cull_back,
               .mirrored = layer.mirrored && layer.cull_back};
    runs_.push_back(run);
  }
}

}  // namespace simvis
