#include "engine/render/draw_cache.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/culling/point_selector.h"
#include "engine/draw/canonical_order.h"
#include "engine/draw/light_block.h"
#include "engine/draw/solid_cloud.h"
#include "shaders/interop.h"

namespace simvis {
namespace {

using Surface = PipelineKey::Surface;

// A few triangles of many vertices are one cluster, which is drawn whole from the device, and levels of round shapes
// have vertices of their own.
bool is_large(const Mesh& mesh) {
  return mesh.topology == Topology::triangles && !has_round_levels(mesh) &&
         std::min(mesh.positions.size(), mesh.indices.size()) >= kMinLargeVertices;
}

auto state_of(const Drawable& d) {
  return std::tuple(d.key.bits(), d.single_sided, d.mirrored, d.depth_visible, d.texture, d.range.clusters.data());
}

// Whether the lights of a kind, two or more, differ in nothing that shaders read but their position and shadow. It
// follows from this frame alone: shaders for lights that are alike round otherwise, and bytes must not depend on
// earlier frames.
bool all_alike(const DrawList& list, LightKind kind) {
  std::optional<shader::LightBlock> first;
  bool several = false;
  for (const LightItem& item : list.lights) {
    if (item.light.kind != kind) continue;
    const shader::LightBlock block = make_light_block(item.light, list.world_from_node[item.transform]);
    if (kind == LightKind::spot && first && block.direction != first->direction) return false;
    if (first && block.intensity != first->intensity) return false;
    several = first.has_value();
    first = block;
  }
  return several;
}

LightCounts count_lights(const DrawList& list) {
  LightCounts counts;
  for (const LightItem& item : list.lights) {
    const LightKind kind = item.light.kind;
    ++(kind == LightKind::directional ? counts.directional : kind == LightKind::point ? counts.point : counts.spot);
    counts.ranged |= kind != LightKind::directional && item.light.range_m > 0;
  }
  counts.alike_point = all_alike(list, LightKind::point);
  counts.alike_spot = all_alike(list, LightKind::spot);
  return counts;
}

// Whether a map, if present, changes the appearance of the material.
bool has_effect(const Material& material, MapKind kind) {
  switch (kind) {
    case MapKind::normal:
      return material.normal_scale != 0;
    case MapKind::metallic_roughness:
      return true;
    case MapKind::occlusion:
      return material.occlusion_strength > 0;
    case MapKind::emissive:
      return material.emissive != glm::vec3(0);
  }
  return true;
}

}  // namespace

void DrawCache::update(const DrawList& list, const Uses& uses, GeometryPool& geometry, LevelStore& levels,
                       TextureStore& textures, Uploads& uploads) {
  const bool color = uses.triangles == MeshUse::attributes;
  const TableChange tables = update_tables(list);
  bool recolored = false;
  const bool new_kinds = update_materials(list, recolored);
  const bool new_mirrors = update_transforms(list);
  if (color && list.lights.size() > SIMVIS_MAX_LIGHTS) {
    throw InputError("the scene has " + std::to_string(list.lights.size()) + " lights, expected at most " +
                     std::to_string(SIMVIS_MAX_LIGHTS));
  }
  const LightCounts lights = color ? count_lights(list) : lights_;
  if (color) light_order_ = light_order(list);
  if (tables.meshes) mesh_ranks_ = canonical_ranks(meshes_);
  const bool new_ranks = recolored && update_material_ranks();
  const bool rebuilds = tables.items || new_kinds || new_mirrors || lights_ != lights || !covers(uses);
  if (rebuilds) {
    lights_ = lights;
    add_uses(uses, tables.structure);
    rebuild(geometry, levels, textures, uploads);
  }
  if (rebuilds || new_ranks) {
    rank_and_sort(list);
  } else {
    for (RenderQueue* drawables : {&depth_, &solid_, &blended_}) sort(*drawables, list);
  }
  version_ = list.changes.version();
}

// Returns whether the device holds the mesh data for these uses.
bool DrawCache::covers(const Uses& uses) const {
  return uses.triangles <= use_ && (with_levels_ || !uses.coarser) && (clouds_on_device_ || !uses.clouds_on_device) &&
         (large_on_device_ || !uses.large_on_device);
}

// Uses only increase until the structure of the list changes. Large meshes that were uploaded stay on the device.
void DrawCache::add_uses(const Uses& uses, bool new_structure) {
  use_ = new_structure ? uses.triangles : std::max(use_, uses.triangles);
  clouds_on_device_ = uses.clouds_on_device || (clouds_on_device_ && !new_structure);
  large_on_device_ |= uses.large_on_device;
  with_levels_ |= uses.coarser;
}

DrawCache::TableChange DrawCache::update_tables(const DrawList& list) {
  if (made_) {
    if (const auto changed = list.changes.items_since(version_)) return update_items(list, *changed);
    if (items_ == list.items && meshes_ == list.meshes && materials_.size() == list.materials.size()) return {};
  }
  SIMVIS_ASSERT(list.material_revision.size() == list.materials.size());
  for (const DrawItem& item : list.items) {
    SIMVIS_ASSERT(item.mesh < list.meshes.size() && item.material < list.materials.size());
  }
  made_ = true;
  items_ = list.items;
  meshes_ = list.meshes;
  materials_ = list.materials;
  kinds_.clear();
  return {.structure = true, .meshes = true, .items = true};
}

DrawCache::TableChange DrawCache::update_items(const DrawList& list, std::span<const std::uint32_t> changed) {
  TableChange change{.items = !changed.empty()};
  for (const std::uint32_t i : changed) {
    items_[i] = list.items[i];
    std::shared_ptr<const Mesh>& mesh = meshes_[items_[i].mesh];
    change.meshes |= mesh != list.meshes[items_[i].mesh];
    mesh = list.meshes[items_[i].mesh];
  }
  return change;
}

DrawCache::MaterialKind DrawCache::kind_of(const Material& material) {
  MaterialKind kind;
  const bool blend = material.alpha_mode == AlphaMode::blend, faded = material.opacity < 1;
  if (material.alpha_mode != AlphaMode::opaque) kind.in_color = kind.in_depth = Surface::masked;
  if (faded) kind.in_color = Surface::faded;
  if (blend) kind.in_color = Surface::blended;
  // An upper bound: textures and vertex colours only reduce alpha.
  const float max_solid = material.opacity * (blend ? material.base_color.a : 1);
  kind.seen = max_solid > 0;
  kind.depth_visible = max_solid >= kMinDepthVisibleAlpha;
  kind.unlit = material.unlit;
  kind.metallic = material.metallic > 0;
  kind.glossy = material.roughness < 1 || kind.metallic || material.map(MapKind::metallic_roughness).texture != nullptr;
  kind.double_sided = material.double_sided;
  // A cutoff of 0 removes no texel.
  kind.shown.alpha_covers = blend || (material.alpha_mode == AlphaMode::mask && material.alpha_cutoff > 0);
  kind.shown.textures[SIMVIS_BASE_COLOR_TEXTURE] = material.base_color_texture;
  for (std::size_t i = 0; i < kMapKinds && !material.unlit; ++i) {
    if (has_effect(material, static_cast<MapKind>(i))) {
      kind.shown.textures[SIMVIS_FIRST_MAP + i] = material.maps[i].texture;
    }
  }
  return kind;
}

// Returns whether the kind of a material has changed. `recolored`: any property of a material has changed.
bool DrawCache::update_materials(const DrawList& list, bool& recolored) {
  SIMVIS_ASSERT(list.material_revision.size() == materials_.size());
  if (kinds_.size() == materials_.size() && materials_ == list.materials &&
      material_revision_ == list.material_revision) {
    return false;
  }
  recolored = true;
  materials_ = list.materials;
  material_revision_ = list.material_revision;
  kinds_.resize(materials_.size());
  bool changed = false;
  for (std::size_t m = 0; m < materials_.size(); ++m) {
    MaterialKind kind = kind_of(*materials_[m]);
    if (kinds_[m] == kind) continue;
    kinds_[m] = std::move(kind);
    changed = true;
  }
  return changed;
}

// Returns whether the ranks have changed.
bool DrawCache::update_material_ranks() {
  std::vector<std::uint32_t> ranks = canonical_ranks(materials_);
  ranks.swap(material_ranks_);
  return ranks != material_ranks_;
}

bool DrawCache::update_transforms(const DrawList& list) {
  mirrored_.resize(items_.size());
  index_ = index_of(list);
  moved_.clear();
  const auto written = list.changes.moved_since(version_);
  all_moved_ = !written;
  bool changed = false;
  if (written) {
    for (const TransformRange& entries : *written) {
      const auto items = index_->standing_at(entries);
      moved_.insert(moved_.end(), items.begin(), items.end());
    }
    for (const std::uint32_t item : moved_) changed |= update_mirrored(list, item);
    return changed;
  }
  boxes_.resize(index_ ? 0 : items_.size());
  for (std::uint32_t i = 0; i < items_.size(); ++i) {
    SIMVIS_ASSERT(items_[i].transform < list.world_from_node.size());
    changed |= update_mirrored(list, i);
    if (index_) continue;
    const Mesh& mesh = *meshes_[items_[i].mesh];
    const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max);
    boxes_[i] = make_box(list.world_from_node[items_[i].transform], (low + high) * 0.5, (high - low) * 0.5);
  }
  return changed;
}

// Returns whether the value has changed.
bool DrawCache::update_mirrored(const DrawList& list, std::uint32_t item) {
  const glm::dmat3 world_from_mesh(list.world_from_node[items_[item].transform]);
  const bool mirrored = glm::dot(glm::cross(world_from_mesh[0], world_from_mesh[1]), world_from_mesh[2]) < 0;
  return std::exchange(mirrored_[item], mirrored) != mirrored;
}

std::uint64_t DrawCache::find_seen(const ViewProjection& projection, std::vector<std::uint32_t>& items) const {
  if (index_) return index_->find_seen(projection, items);
  for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
    if (!outside(projection, boxes_[i])) items.push_back(i);
  }
  return boxes_.size();
}

std::size_t DrawCache::PooledMeshes::add(const std::shared_ptr<const Mesh>& mesh, MeshUse use) {
  meshes.push_back(mesh);
  uses.push_back(use);
  return meshes.size() - 1;
}

// The levels of a mesh, and its tiles, are further meshes of the pool.
void DrawCache::add_tiles(PooledMeshes& all, LevelStore& levels) {
  std::vector<std::shared_ptr<const Mesh>> levelled = meshes_;
  for (std::size_t i = 0; i < levelled.size(); ++i) {
    if (all.uses[i] == MeshUse::none || has_round_levels(*levelled[i])) levelled[i] = nullptr;
  }
  levels.update(levelled);
  for (std::size_t i = 0; i < meshes_.size(); ++i) {
    first_tile_.push_back(all.tiles.size());
    for (const LevelledTile& tile : levels.tiles_of(meshes_[i].get())) {
      all.tiles.push_back(tile.mesh == meshes_[i] ? i : all.add(tile.mesh, MeshUse::attributes));
      for (const MeshLevel& level : tile.levels) {
        level_ranges_.push_back({.error_m = level.error_m, .range = {}});
        all.levels.push_back(all.add(level.mesh, MeshUse::attributes));
      }
    }
  }
  first_tile_.push_back(all.tiles.size());
}

// Each level of a round shape is used as its mesh is.
void DrawCache::add_round(PooledMeshes& all) {
  rounds_.keep_only(meshes_);
  if (std::ranges::none_of(meshes_, [](const auto& mesh) { return has_round_levels(*mesh); })) return;
  for (std::size_t i = 0; i < meshes_.size(); ++i) {
    first_round_.push_back(all.round.size());
    if (all.uses[i] == MeshUse::none || !has_round_levels(*meshes_[i])) continue;
    const RoundStore::Levels& levels = rounds_.levels_of(meshes_[i]);
    for (std::size_t level = 0; level < round_levels_of(*meshes_[i]->surface); ++level) {
      const std::shared_ptr<const Mesh>& mesh = levels[level];
      all.round.push_back(mesh == nullptr      ? PooledMeshes::kNowhere
                          : mesh == meshes_[i] ? i
                                               : all.add(mesh, all.uses[i]));
    }
  }
  first_round_.push_back(all.round.size());
}

void DrawCache::place_meshes(std::span<const MeshUse> uses, GeometryPool& geometry, LevelStore& levels,
                             Uploads& uploads) {
  level_ranges_.clear();
  tiles_.clear();
  first_tile_.clear();
  first_round_.clear();
  PooledMeshes all{meshes_, {uses.begin(), uses.end()}};
  if (with_levels_) add_tiles(all, levels);
  add_round(all);
  const std::span<const MeshRange> ranges = geometry.update(all.meshes, all.uses, uploads);
  ranges_.assign(ranges.begin(), ranges.begin() + static_cast<std::ptrdiff_t>(meshes_.size()));
  for (std::size_t i = 0; i < level_ranges_.size(); ++i) level_ranges_[i].range = ranges[all.levels[i]];
  round_ranges_.assign(all.round.size(), MeshRange{});
  for (std::size_t i = 0; i < all.round.size(); ++i) {
    if (all.round[i] != PooledMeshes::kNowhere) round_ranges_[i] = ranges[all.round[i]];
  }
  if (!with_levels_) return;
  std::size_t tile = 0, level = 0;
  for (const std::shared_ptr<const Mesh>& mesh : meshes_) {
    for (const LevelledTile& each : levels.tiles_of(mesh.get())) {
      tiles_.push_back({ranges[all.tiles[tile++]], std::span(level_ranges_).subspan(level, each.levels.size())});
      level += each.levels.size();
    }
  }
}

void DrawCache::add_levels(std::span<const LackingLevel> lacking, const DrawList& list, GeometryPool& geometry,
                           LevelStore& levels, TextureStore& textures, Uploads& uploads) {
  for (const LackingLevel& each : lacking) rounds_.make(meshes_[each.mesh], each.level);
  rebuild(geometry, levels, textures, uploads);
  rank_and_sort(list);
}

void DrawCache::rank_and_sort(const DrawList& list) {
  for (RenderQueue* drawables : {&depth_, &solid_, &blended_}) rank_and_group(drawables->drawables());
  all_moved_ = true;
  for (RenderQueue* drawables : {&depth_, &solid_, &blended_}) sort(*drawables, list);
}

void DrawCache::rebuild(GeometryPool& geometry, LevelStore& levels, TextureStore& textures, Uploads& uploads) {
  place_meshes(find_uses(), geometry, levels, uploads);
  show_textures(textures, uploads);
  fill_queues();
}

// Returns by mesh what the visible items need of it. Notes the materials that they read, and whether any is lit.
std::vector<MeshUse> DrawCache::find_uses() {
  std::vector<MeshUse> uses(meshes_.size(), MeshUse::none);
  materials_read_.assign(materials_.size(), 0);
  any_lit_ = false;
  for (const DrawItem& item : items_) {
    const MaterialKind& kind = kinds_[item.material];
    if (!item.visible) continue;
    if (!kind.depth_visible && !(with_color() && kind.seen)) continue;
    uses[item.mesh] = std::max(uses[item.mesh], use_of(*meshes_[item.mesh], kind));
    materials_read_[item.material] |= with_color() || kind.in_depth != Surface::opaque;
    any_lit_ |= !kind.unlit;
  }
  max_copies_ = 0;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const bool is_copied = uses[i] != MeshUse::none && uses[i] < MeshUse::positions;
    if (is_copied && is_large(*meshes_[i])) max_copies_ += meshes_[i]->positions.size() / kMinVerticesPerCopy;
  }
  return uses;
}

void DrawCache::show_textures(TextureStore& textures, Uploads& uploads) {
  textures.keep_only(materials_);
  texture_sets_.assign(materials_.size(), VK_NULL_HANDLE);
  textures_shown_.assign(materials_.size(), 0);
  for (std::size_t m = 0; m < materials_.size(); ++m) {
    if (!materials_read_[m]) continue;
    const TextureSet set = shown(kinds_[m]);
    for (std::size_t binding = 0; binding < set.textures.size(); ++binding) {
      textures_shown_[m] |= static_cast<std::uint8_t>((set.textures[binding] != nullptr) << binding);
    }
    if (textures_shown_[m] != 0) texture_sets_[m] = textures.require(set, uploads);
  }
}

void DrawCache::fill_queues() {
  for (RenderQueue* drawables : {&depth_, &solid_, &blended_}) drawables->clear(items_.size());
  for (std::uint32_t i = 0; i < items_.size(); ++i) {
    if (!items_[i].visible || ranges_[items_[i].mesh].index_count == 0) continue;
    const MaterialKind& kind = kinds_[items_[i].material];
    if (kind.depth_visible) depth_.add(drawable(i, false));
    if (!with_color() || !kind.seen) continue;
    const Drawable d = drawable(i, true);
    (d.key.blends() ? blended_ : solid_).add(d);
  }
}

// Returns the data of the mesh that an item with a material of this kind needs.
MeshUse DrawCache::use_of(const Mesh& mesh, const MaterialKind& kind) const {
  const bool opaque = kind.in_depth == Surface::opaque && (!with_color() || kind.in_color == Surface::opaque);
  const bool points = mesh.topology == Topology::points && mesh.indices.size() >= kWorthSelectingPoints;
  if (points && opaque && !clouds_on_device_) return MeshUse::clusters;
  if (is_large(mesh) && opaque && !large_on_device_) return with_color() ? MeshUse::shaded_clusters : MeshUse::clusters;
  if (with_color() || kind.in_depth != Surface::opaque) return MeshUse::attributes;
  return mesh.topology == Topology::triangles ? use_ : MeshUse::positions;
}

TextureSet DrawCache::shown(const MaterialKind& kind) const {
  TextureSet set = kind.shown;
  auto& textures = set.textures;
  if (!with_color()) std::fill(textures.begin() + SIMVIS_FIRST_MAP, textures.end(), nullptr);
  // Normals and roughness are visible only if there are lights.
  if (!lights_.any()) textures[SIMVIS_NORMAL_MAP] = textures[SIMVIS_METALLIC_ROUGHNESS_MAP] = nullptr;
  return set;
}

Drawable DrawCache::drawable(std::uint32_t index, bool color) const {
  const DrawItem& item = items_[index];
  const MaterialKind& kind = kinds_[item.material];
  Drawable d;
  d.item = index;
  d.material = item.material;
  d.transform = item.transform;
  d.range = ranges_[item.mesh];
  if (color && with_levels_) {
    const std::size_t first = first_tile_[item.mesh];
    d.tiles = std::span(tiles_).subspan(first, first_tile_[item.mesh + 1] - first);
  }
  if (!first_round_.empty()) {
    const std::size_t first = first_round_[item.mesh];
    d.round = std::span(round_ranges_).subspan(first, first_round_[item.mesh + 1] - first);
  }
  d.single_sided = !kind.double_sided;
  d.mirrored = mirrored_[index] != 0;
  d.depth_visible = kind.depth_visible;
  d.key = key_of(item, color);
  if (is_solid_cloud(*meshes_[item.mesh])) d.point_m = static_cast<float>(2 * meshes_[item.mesh]->surface->radius_m);
  if (d.key.textured || d.key.maps != 0) d.texture = texture_sets_[item.material];
  return d;
}

// Returns the key without what the view adds, see Drawable::key.
PipelineKey DrawCache::key_of(const DrawItem& item, bool color) const {
  const MaterialKind& kind = kinds_[item.material];
  PipelineKey key;
  key.color = color;
  key.depth_only = !color;
  key.topology = meshes_[item.mesh]->topology;
  key.surface = color ? kind.in_color : kind.in_depth;
  constexpr std::uint8_t kBase = 1u << SIMVIS_BASE_COLOR_TEXTURE;
  const std::uint8_t shown = textures_shown_[item.material];
  key.textured = (shown & kBase) != 0 && (color || key.surface != Surface::opaque);
  key.maps = color ? shown & ~kBase : 0;
  key.unlit = color && kind.unlit;
  key.lights = color && !kind.unlit ? lights_ : LightCounts{};
  key.glossy = kind.glossy && key.lights.any();
  key.metallic = kind.metallic && key.glossy;
  return key;
}

void DrawCache::rank_and_group(std::span<Drawable> drawables) const {
  const auto rank_of = [this](const Drawable& d) {
    return std::tuple(d.key.bits(), d.single_sided, d.mirrored, d.depth_visible, mesh_ranks_[items_[d.item].mesh],
                      material_ranks_[d.material]);
  };
  std::map<decltype(rank_of(drawables[0])), std::uint32_t> ranks;
  std::map<decltype(state_of(drawables[0])), std::uint32_t> groups;
  for (Drawable& d : drawables) {
    ranks.try_emplace(rank_of(d));
    d.group = groups.try_emplace(state_of(d), static_cast<std::uint32_t>(groups.size())).first->second;
  }
  std::uint32_t next = 0;
  for (auto& [key, rank] : ranks) rank = next++;
  for (Drawable& d : drawables) d.rank = ranks.at(rank_of(d));
}

void DrawCache::sort(RenderQueue& drawables, const DrawList& list) const {
  if (all_moved_) {
    drawables.sort(list);
  } else {
    drawables.sort(list, moved_);
  }
}

}  // namespace simvis
