// Turns the graph into a DrawList, and keeps it up to date at the cost of what changed.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <unordered_map>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/node.h>

namespace simvis {

/// What update() had to do, counted since the flattener was made.
struct FlattenCounters {
  std::uint64_t rebuilds = 0;            ///< whole traversals, after a change of structure
  std::uint64_t nodes_visited = 0;       ///< in traversals
  std::uint64_t transforms_written = 0;  ///< entries of world_from_node
  std::uint64_t materials_written = 0, lights_written = 0, meshes_written = 0;

  bool operator==(const FlattenCounters&) const = default;
};

/// Who looks at the world: sensors, or people, who see VisualSeparators too.
enum class Audience : std::uint8_t { sensors, people };

/// How it works: a traversal gives each occurrence of a Transform an entry of world_from_node whose parent is the
/// entry in force before it. All that such an entry governs, entries, items and lights, lies between it and the end of
/// the enclosing separator, so a changed transform rewrites one contiguous range and nothing else. A changed light or
/// material rewrites its slot. Nothing changed costs nothing. Traversal uses an explicit stack: depth is no limit.
class Flattener : public NodeObserver {
 public:
  explicit Flattener(GroupPtr root, Audience audience = Audience::sensors);
  ~Flattener() override;
  Flattener(const Flattener&) = delete;
  Flattener& operator=(const Flattener&) = delete;

  /// The list, up to date. Valid until the next update(). Throws InputError when the graph has a cycle.
  const DrawList& update();

  /// Where a mount stands, as of the last update(): world_from_mount of its first occurrence. The mount must have been
  /// reached; false otherwise (it is in a part switched off).
  bool find_mount(const Mount& mount, glm::dmat4& world_from_mount) const;

  const FlattenCounters& counters() const { return counters_; }

  void content_changed(Node& node) override;
  void structure_changed() override;

 private:
  struct Entry {            // an occurrence of a Transform
    const Transform* node;  // null: the identity, entry 0
    std::uint32_t parent;   // the entry in force before
    std::uint32_t end;      // one past the last entry that it governs
  };
  struct Range {
    std::uint32_t first, end;
  };
  class Traversal;

  void rebuild();
  void forget();
  void rewrite_changed();
  void rewrite_transforms(std::vector<Range>& ranges);

  GroupPtr root_;
  Audience audience_;
  DrawList list_;
  FlattenCounters counters_;
  std::vector<Entry> entries_;
  std::unordered_map<const Node*, std::vector<std::uint32_t>>
      occurrences_;  // entries, slots of materials or meshes, or lights
  std::unordered_map<const Mount*, std::uint32_t> mounts_;
  const EnvironmentNode* environment_node_ = nullptr;  // the one that counts
  const MediumNode* medium_node_ = nullptr;            // likewise
  std::vector<NodePtr> attached_;                      // held, so that a changed node is there when update() comes
  std::vector<Node*> changed_;
  bool structure_changed_ = true;
};

}  // namespace simvis
