// Turns the scene graph into a DrawList and updates only the changed parts.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/node.h>

namespace simvis {

/// The work done by update(), counted since the flattener was made.
struct FlattenCounters {
  std::uint64_t rebuilds = 0;            ///< full traversals, after a change of structure
  std::uint64_t nodes_visited = 0;       ///< in traversals
  std::uint64_t transforms_written = 0;  ///< entries of world_from_node
  std::uint64_t materials_written = 0, lights_written = 0, meshes_written = 0;
  std::uint64_t items_shown_or_hidden = 0;  ///< items whose visibility changed without a traversal

  bool operator==(const FlattenCounters&) const = default;
};

/// The viewers of the world: sensors, or people. Only people see VisualSeparators.
enum class Audience : std::uint8_t { sensors, people };

/// Where an item of the draw list comes from. The nodes live as long as the graph is not changed.
struct ItemSource {
  const InsertionPoint* point = nullptr;  ///< of the part or link that has the shape; null: nothing in front of it
  const Shape* shape = nullptr;
  const MaterialNode* material = nullptr;  ///< null: the default material
  std::uint32_t group = 0;                 ///< for Flattener::names_of()
};

/// A name that an item has in its file.
struct ShapeName {
  std::string_view name;
  std::uint32_t group = 0;  ///< the occurrence of the group that has the name; 0: the item's shape itself has it
};

/// A traversal gives each occurrence of a Transform an entry of world_from_node. The parent of the entry is the entry
/// in force before it. All entries, items and lights that an entry governs lie between it and the end of the enclosing
/// separator, so a changed transform rewrites one contiguous range and nothing else. A changed light or material
/// rewrites its slot. A changed visibility rewrites the items that it governs; only if it also governs lights, whose
/// number shaders are compiled for, the graph is traversed again. An unchanged graph costs nothing. The traversal uses
/// an explicit stack, so the depth of the graph is not limited.
class Flattener : public NodeObserver {
 public:
  explicit Flattener(GroupPtr root, Audience audience = Audience::sensors);
  ~Flattener() override;
  Flattener(const Flattener&) = delete;
  Flattener& operator=(const Flattener&) = delete;

  /// Updates the list and returns it. It is valid until the next update(). Throws InputError if the graph has a cycle.
  const DrawList& update();

  /// Gives the pose of a mount as of the last update(): world_from_mount of its first occurrence. Returns false if the
  /// traversal did not reach the mount, for example below a switch that is off.
  bool find_mount(const Mount& mount, glm::dmat4& world_from_mount) const;
  /// The place of that occurrence in DrawList::world_from_node; none if the traversal did not reach the mount.
  std::optional<std::uint32_t> transform_of(const Mount& mount) const;

  /// What stands at an insertion point.
  struct PointPlace {
    std::uint32_t transform = 0;                 ///< in DrawList::world_from_node
    std::uint32_t first_item = 0, end_item = 0;  ///< of the group that has the point, in DrawList::items
  };
  /// Makes find_point() known for these nodes, and for no other, from the next update() on.
  void watch(std::unordered_set<const Node*> points);
  /// The place of a watched insertion point as of the last update(): its first occurrence. Null if the traversal did
  /// not reach it.
  const PointPlace* find_point(const Node& point) const;

  /// The node of an entry of world_from_node; null: the identity, entry 0.
  const Transform* node_of(std::uint32_t transform) const { return entries_[transform].node; }
  /// The entry that is in force in front of an entry of world_from_node; of entry 0: itself.
  std::uint32_t parent_of(std::uint32_t transform) const { return entries_[transform].parent; }

  /// By item of the last update().
  const std::vector<ItemSource>& item_sources() const { return item_sources_; }
  /// The place of an item of the last update() in DrawList::world_from_node.
  std::uint32_t item_transform(std::uint32_t item) const { return list_.items[item].transform; }

  /// The names that an item of the last update() has in its file: that of its shape, and those of the groups around it,
  /// up to the one that has its insertion point. The nearest comes first. Valid as long as the nodes.
  std::vector<ShapeName> names_of(const ItemSource& item) const;

  /// The place in DrawList::world_from_node of the first occurrence of an insertion point as of the last update(); none
  /// if the traversal did not reach it.
  std::optional<std::uint32_t> transform_of(const Node& point) const;
  /// The transform that leads from one entry of DrawList::world_from_node to one that it governs: the product of the
  /// nodes between them, whose rounding does not depend on where they stand. None if it does not govern it.
  std::optional<glm::dmat4> between(std::uint32_t outer, std::uint32_t inner) const;

  const FlattenCounters& counters() const { return counters_; }

  void content_changed(Node& node) override;
  void structure_changed() override;

 private:
  struct Entry {            // one occurrence of a Transform
    const Transform* node;  // null: the identity, entry 0
    std::uint32_t parent;   // the entry in force before this one
    std::uint32_t end;      // one past the last entry that it governs
  };
  struct Range {
    std::uint32_t first, end;
  };
  struct VisibilityEntry {   // one occurrence of a Visibility
    const Visibility* node;  // null: always visible, entry 0
    std::uint32_t parent;    // the entry in force before this one
    Range items;             // that it governs
    bool has_lights;         // whether it governs lights
  };
  struct NamedGroup {      // one occurrence of a group with a name
    const Group* group;    // null: none, entry 0
    std::uint32_t parent;  // the entry of the next one around it
  };
  class Traversal;

  void rebuild();
  void forget();
  void rewrite_changed();
  bool changes_lights() const;
  bool is_visible(std::uint32_t visibility) const;
  void rewrite_mesh(const Shape& shape, std::uint32_t slot);
  void rewrite_visibility(const Range& items);
  void rewrite_transforms(std::vector<Range>& ranges);

  GroupPtr root_;
  Audience audience_;
  DrawList list_;
  std::vector<ItemSource> item_sources_;
  FlattenCounters counters_;
  std::vector<Entry> entries_;
  std::vector<VisibilityEntry> visibilities_;
  std::vector<NamedGroup> named_groups_;
  std::vector<std::uint32_t> visibility_of_;  // by item
  std::unordered_map<const Node*, std::vector<std::uint32_t>>
      occurrences_;  // entries, visibilities, slots of materials or meshes, or lights
  std::unordered_map<const Shape*, std::vector<std::uint32_t>> items_of_;  // of shapes whose mesh has a slot of its own
  std::unordered_map<const Mount*, std::uint32_t> mounts_;
  std::unordered_set<const Node*> watched_;
  std::unordered_map<const Node*, PointPlace> points_;            // of watched_
  std::unordered_map<const Node*, std::uint32_t> point_entries_;  // the entry at each insertion point
  const EnvironmentNode* environment_node_ = nullptr;             // the last one in traversal order
  const SkyNode* sky_node_ = nullptr;                             // the last one in traversal order
  const MediumNode* medium_node_ = nullptr;                       // the last one in traversal order
  std::vector<NodePtr> attached_;                                 // keeps changed nodes alive until update()
  std::vector<Node*> changed_;
  bool structure_changed_ = true;
};

}  // namespace simvis
