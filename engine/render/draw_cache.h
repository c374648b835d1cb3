// Cached render queues of a draw list. They are rebuilt only when the structure of the list or the kind of a material
// changes, not when a colour changes.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include "engine/geometry/item_index.h"
#include "engine/geometry/round_store.h"
#include "engine/geometry/view_projection.h"
#include "engine/render/geometry_pool.h"
#include "engine/render/level_store.h"
#include "engine/render/render_queue.h"
#include "engine/render/texture_store.h"
#include "engine/vulkan/uploads.h"

namespace simvis {

/// Views of a CPU device copy what they see of opaque triangles of meshes with at least this many vertices and corners,
/// which are not uploaded. Of smaller meshes an upload takes little memory, and copies in each frame would take time.
inline constexpr std::size_t kMinLargeVertices = 1u << 20;
/// Views may copy one in so many of their vertices in a frame. If they see more, these meshes are uploaded.
inline constexpr std::size_t kMinVerticesPerCopy = 2;

/// If the list has a change log (see DrawListDelta), the cache reads only the changes. Otherwise it compares the list
/// with its own copy.
class DrawCache {
 public:
  /// Data of the meshes of a list that a frame needs.
  struct Uses {
    /// Data of opaque triangles, at least clusters. `attributes` means that the frame shows colour; until a frame does,
    /// textures and vertex attributes of opaque surfaces are not uploaded.
    MeshUse triangles = MeshUse::clusters;
    bool clouds_on_device = true;  ///< large clouds of opaque points are drawn as they are; until a frame does that,
                                   ///< they are not uploaded
    bool large_on_device = true;   ///< the same of large meshes of opaque triangles
    bool coarser = false;          ///< coarser levels are drawn; until a frame does that, there are none
  };

  /// Brings the cache up to date.
  void update(const DrawList& list, const Uses& uses, GeometryPool& geometry, LevelStore& levels,
              TextureStore& textures, Uploads& uploads);

  /// All drawables, for passes without colour.
  const RenderQueue& depth() const { return depth_; }
  /// For passes with colour: solid drawables, and transparent drawables that are blended over them.
  const RenderQueue& solid() const { return solid_; }
  const RenderQueue& blended() const { return blended_; }

  /// Indices of the list's lights in the order in which they are summed up, see engine/draw/canonical_order.h.
  std::span<const std::uint32_t> lights() const { return light_order_; }

  /// Valid until the list changes.
  const WorldBox& box(std::uint32_t item) const { return index_ ? index_->box(item) : boxes_[item]; }
  /// Appends the items whose boxes are not outside the view, in any order. Returns the number of boxes examined.
  std::uint64_t find_seen(const ViewProjection& projection, std::vector<std::uint32_t>& items) const;
  /// By material: not 0 if a drawable reads the material's block.
  std::span<const std::uint8_t> materials_read() const { return materials_read_; }
  /// By material: bit mask of the textures that are shown, bit number = binding.
  std::span<const std::uint8_t> textures_shown() const { return textures_shown_; }
  bool any_lit() const { return any_lit_; }
  /// The number of vertices of large meshes that the views of a frame may copy: a kMinVerticesPerCopy-th of those of
  /// the visible meshes that are not on the device.
  std::size_t max_copies() const { return max_copies_; }
  /// The number of coarser levels on the device.
  std::size_t levels_held() const { return level_ranges_.size(); }

  /// Makes levels of round shapes that views of this frame lack. `list`, and the others, as in the last update().
  void add_levels(std::span<const LackingLevel> lacking, const DrawList& list, GeometryPool& geometry,
                  LevelStore& levels, TextureStore& textures, Uploads& uploads);

  /// Resets the cache to empty.
  void clear() { *this = DrawCache(); }

 private:
  // The properties of a material that select its pipelines and textures.
  struct MaterialKind {
    PipelineKey::Surface in_color = PipelineKey::Surface::opaque, in_depth = PipelineKey::Surface::opaque;
    bool seen = true, depth_visible = true;  // in colour passes, in depth passes
    bool unlit = false, glossy = false, metallic = false, double_sided = false;
    TextureSet shown;
    bool operator==(const MaterialKind&) const = default;
  };
  static MaterialKind kind_of(const Material& material);
  struct TableChange {
    bool structure = false;  // the number or order of items, or of materials
    bool meshes = false, items = false;
  };
  bool covers(const Uses& uses) const;
  void add_uses(const Uses& uses, bool new_structure);
  TableChange update_tables(const DrawList& list);
  TableChange update_items(const DrawList& list, std::span<const std::uint32_t> changed);
  bool update_materials(const DrawList& list, bool& recolored);
  bool update_material_ranks();
  bool update_transforms(const DrawList& list);
  bool update_mirrored(const DrawList& list, std::uint32_t item);
  void rebuild(GeometryPool& geometry, LevelStore& levels, TextureStore& textures, Uploads& uploads);
  std::vector<MeshUse> find_uses();
  void show_textures(TextureStore& textures, Uploads& uploads);
  void fill_queues();
  void place_meshes(std::span<const MeshUse> uses, GeometryPool& geometry, LevelStore& levels, Uploads& uploads);
  /// Meshes for the pool: those of the list first.
  struct PooledMeshes {
    std::vector<std::shared_ptr<const Mesh>> meshes;
    std::vector<MeshUse> uses;
    std::vector<std::size_t> tiles{}, levels{}, round{};  // places in `meshes`; kNowhere: not made

    static constexpr std::size_t kNowhere = ~std::size_t{0};
    std::size_t add(const std::shared_ptr<const Mesh>& mesh, MeshUse use);
  };
  MeshUse use_of(const Mesh& mesh, const MaterialKind& kind) const;
  void add_tiles(PooledMeshes& all, LevelStore& levels);
  void add_round(PooledMeshes& all);
  bool with_color() const { return use_ == MeshUse::attributes; }
  TextureSet shown(const MaterialKind& kind) const;
  Drawable drawable(std::uint32_t item, bool color) const;
  PipelineKey key_of(const DrawItem& item, bool color) const;
  void rank_and_group(std::span<Drawable> drawables) const;
  void sort(RenderQueue& drawables, const DrawList& list) const;
  void rank_and_sort(const DrawList& list);

  bool made_ = false;
  bool any_lit_ = false;
  MeshUse use_ = MeshUse::none;    // of opaque triangles: the maximum since the structure last changed
  bool clouds_on_device_ = false;  // as Uses: whether a frame has drawn them since the structure last changed
  bool large_on_device_ = false;   // as Uses: whether a frame has drawn them
  std::size_t max_copies_ = 0;
  bool with_levels_ = false;  // a frame has drawn coarser levels
  LightCounts lights_{};
  std::vector<DrawItem> items_;
  std::vector<std::shared_ptr<const Mesh>> meshes_;
  std::vector<std::shared_ptr<const Material>> materials_;
  std::vector<std::uint64_t> material_revision_;
  std::vector<MaterialKind> kinds_;
  ListVersion version_;                 // version of the list at the last update()
  const ItemIndex* index_ = nullptr;    // null if the list has no change log
  std::vector<WorldBox> boxes_;         // by item; used without an index
  std::vector<std::uint32_t> moved_;    // items moved since the previous update(), from the change log
  bool all_moved_ = true;               // true also where the moved items are unknown
  std::vector<std::uint8_t> mirrored_;  // by item
  std::vector<std::uint8_t> materials_read_, textures_shown_;
  std::vector<VkDescriptorSet> texture_sets_;  // by material
  std::vector<MeshRange> ranges_;              // by mesh
  std::vector<LevelRange> level_ranges_;       // tile by tile
  std::vector<LevelledRange> tiles_;           // mesh by mesh
  std::vector<std::size_t> first_tile_;        // by mesh, in tiles_; its size at the end. Empty without levels
  RoundStore rounds_;
  std::vector<MeshRange> round_ranges_;   // levels of round shapes, mesh by mesh
  std::vector<std::size_t> first_round_;  // by mesh, in round_ranges_; its size at the end. Empty without any
  std::vector<std::uint32_t> mesh_ranks_, material_ranks_, light_order_;
  RenderQueue depth_, solid_, blended_;
};

}  // namespace simvis
