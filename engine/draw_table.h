// A draw list made ready for drawing: sorted by what the GPU would have to switch and then by content, with all that a
// view needs of an item side by side. Remade only when the list's structure or a material's kind changes: not for
// another colour.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/draw_list.h"
#include "engine/geometry_pool.h"
#include "engine/pipelines.h"
#include "engine/texture_store.h"
#include "engine/uploads.h"
#include "engine/view_projection.h"

namespace simvis {

/// An item as one kind of pass draws it.
struct Drawable {
  PipelineKey key;  ///< `cull_back` and `mirrored` are settled by the view
  bool single_sided = false, mirrored = false;
  bool met = true;  ///< depth meets it, at least where it is most solid
  std::uint32_t item = 0, material = 0, transform = 0;
  std::uint32_t group = 0;  ///< equal for neighbours that one instanced draw can take
  VkDescriptorSet texture = VK_NULL_HANDLE;
  MeshRange range;
};

/// The table compares what it was made from with the list that it is given instead of trusting `revisions.structure`:
/// that costs less than culling the same items once, and lists of different origin cannot be mistaken.
class DrawTable {
 public:
  /// Brings the table up to date. `use`: what this frame needs of opaque triangles, at least their clusters; what needs
  /// attributes shows colour, and without any that does neither textures nor attributes of what is opaque are uploaded.
  void update(const DrawList& list, MeshUse use, GeometryPool& geometry, TextureStore& textures, Uploads& uploads);

  /// Everything, for passes without colour.
  std::span<const Drawable> depth() const { return depth_; }
  /// For passes with colour: what is solid, and what is blended over it.
  std::span<const Drawable> solid() const { return solid_; }
  std::span<const Drawable> blended() const { return blended_; }

  /// The numbers of the list's lights in the order in which they are summed up, see engine/content_order.h.
  std::span<const std::uint32_t> lights() const { return light_order_; }

  const WorldBox& box(std::uint32_t item) const { return boxes_[item]; }
  /// By material: not 0 where what is drawn reads its block.
  std::span<const std::uint8_t> materials_read() const { return materials_read_; }
  /// By material: a sum of 1 << binding of the textures that are shown.
  std::span<const std::uint8_t> textures_shown() const { return textures_shown_; }
  bool any_lit() const { return any_lit_; }

  /// Forgets everything.
  void clear() { *this = DrawTable(); }

 private:
  // What of a material decides how it is drawn.
  struct MaterialKind {
    PipelineKey::Surface in_color = PipelineKey::Surface::opaque, in_depth = PipelineKey::Surface::opaque;
    bool seen = true, met = true;  // by colour, by depth
    bool unlit = false, glossy = false, metallic = false, double_sided = false;
    TextureSet textures;
    bool operator==(const MaterialKind&) const = default;
  };
  static MaterialKind kind_of(const Material& material);
  bool take_tables(const DrawList& list);
  bool take_materials(const DrawList& list, bool& recolored);
  bool take_transforms(const DrawList& list);
  void rebuild(GeometryPool& geometry, TextureStore& textures, Uploads& uploads);
  bool with_color() const { return use_ == MeshUse::attributes; }
  TextureSet shown(const MaterialKind& kind) const;
  Drawable drawable(std::uint32_t item, bool color) const;
  void sort_and_group(std::vector<Drawable>& drawables, const DrawList& list) const;

  bool made_ = false;
  bool any_lit_ = false;
  MeshUse use_ = MeshUse::none;  // of opaque triangles, by any frame so far
  std::uint16_t lights_ = 0;
  std::vector<DrawItem> items_;
  std::vector<std::shared_ptr<const Mesh>> meshes_;
  std::vector<std::shared_ptr<const Material>> materials_;
  std::vector<std::uint64_t> material_revision_;
  std::vector<MaterialKind> kinds_;
  std::vector<WorldBox> boxes_;         // by item
  std::vector<std::uint8_t> mirrored_;  // by item
  std::vector<std::uint8_t> materials_read_, textures_shown_;
  std::vector<VkDescriptorSet> texture_sets_;  // by material
  std::vector<MeshRange> ranges_;              // by mesh
  std::vector<std::uint32_t> mesh_ranks_, material_ranks_, light_order_;
  std::vector<Drawable> depth_, solid_, blended_;
};

}  // namespace simvis
