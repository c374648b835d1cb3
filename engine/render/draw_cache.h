// A draw list made ready for drawing, with all that a view needs of an item side by side. Remade only when the list's
// structure or a material's kind changes: not for another colour.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include "engine/geometry/item_index.h"
#include "engine/geometry/view_projection.h"
#include "engine/render/geometry_pool.h"
#include "engine/render/render_queue.h"
#include "engine/render/texture_store.h"
#include "engine/vulkan/uploads.h"

namespace simvis {

/// Of a list whose writer keeps account the table looks at what has changed, see DrawListDelta; it compares what it was
/// made from with any other.
class DrawCache {
 public:
  /// Brings the table up to date. `use`: what this frame needs of opaque triangles, at least their clusters; what needs
  /// attributes shows colour, and without any that does neither textures nor attributes of what is opaque are uploaded.
  void update(const DrawList& list, MeshUse use, GeometryPool& geometry, TextureStore& textures, Uploads& uploads);

  /// Everything, for passes without colour.
  const RenderQueue& depth() const { return depth_; }
  /// For passes with colour: what is solid, and what is blended over it.
  const RenderQueue& solid() const { return solid_; }
  const RenderQueue& blended() const { return blended_; }

  /// The numbers of the list's lights in the order in which they are summed up, see engine/canonical_order.h.
  std::span<const std::uint32_t> lights() const { return light_order_; }

  /// Valid until the list changes.
  const WorldBox& box(std::uint32_t item) const { return index_ ? index_->box(item) : boxes_[item]; }
  /// Adds the items whose boxes are not outside the view, in any order; returns how many boxes that took to look at.
  std::uint64_t find_seen(const ViewProjection& projection, std::vector<std::uint32_t>& items) const;
  /// By material: not 0 where what is drawn reads its block.
  std::span<const std::uint8_t> materials_read() const { return materials_read_; }
  /// By material: a sum of 1 << binding of the textures that are shown.
  std::span<const std::uint8_t> textures_shown() const { return textures_shown_; }
  bool any_lit() const { return any_lit_; }

  /// Forgets everything.
  void clear() { *this = DrawCache(); }

 private:
  // What of a material decides how it is drawn.
  struct MaterialKind {
    PipelineKey::Surface in_color = PipelineKey::Surface::opaque, in_depth = PipelineKey::Surface::opaque;
    bool seen = true, depth_visible = true;  // by colour, by depth
    bool unlit = false, glossy = false, metallic = false, double_sided = false;
    TextureSet textures;
    bool operator==(const MaterialKind&) const = default;
  };
  static MaterialKind kind_of(const Material& material);
  bool update_tables(const DrawList& list);
  bool update_materials(const DrawList& list, bool& recolored);
  bool update_material_ranks();
  bool update_transforms(const DrawList& list);
  bool update_mirrored(const DrawList& list, std::uint32_t item);
  void rebuild(GeometryPool& geometry, TextureStore& textures, Uploads& uploads);
  bool with_color() const { return use_ == MeshUse::attributes; }
  TextureSet shown(const MaterialKind& kind) const;
  Drawable drawable(std::uint32_t item, bool color) const;
  void rank_and_group(std::span<Drawable> drawables) const;
  void sort(RenderQueue& drawables, const DrawList& list) const;

  bool made_ = false;
  bool any_lit_ = false;
  MeshUse use_ = MeshUse::none;  // of opaque triangles, by any frame so far
  std::uint16_t lights_ = 0;
  std::vector<DrawItem> items_;
  std::vector<std::shared_ptr<const Mesh>> meshes_;
  std::vector<std::shared_ptr<const Material>> materials_;
  std::vector<std::uint64_t> material_revision_;
  std::vector<MaterialKind> kinds_;
  ListVersion version_;                 // of the list as of the last update()
  const ItemIndex* index_ = nullptr;    // of a list of which account is kept
  std::vector<WorldBox> boxes_;         // by item, without
  std::vector<std::uint32_t> moved_;    // items, by that account, since the update before
  bool all_moved_ = true;               // or nobody knows which
  std::vector<std::uint8_t> mirrored_;  // by item
  std::vector<std::uint8_t> materials_read_, textures_shown_;
  std::vector<VkDescriptorSet> texture_sets_;  // by material
  std::vector<MeshRange> ranges_;              // by mesh
  std::vector<std::uint32_t> mesh_ranks_, material_ranks_, light_order_;
  RenderQueue depth_, solid_, blended_;
};

}  // namespace simvis
