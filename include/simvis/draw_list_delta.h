// The change log of a draw list. With it a reader updates only what the producer of the list has changed.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <simvis/export.h>

namespace simvis {

class ItemIndex;
struct DrawList;

/// Entries [first, end) of DrawList::world_from_node.
struct TransformRange {
  std::uint32_t first = 0,  ///< first entry
      end = 0;              ///< one past the last entry
};

/// The state of a list that a reader has seen. The default value stands for "nothing seen".
struct ListVersion {
  /// Unique among all lists of this process; 0: the list has no change log.
  std::uint64_t structure = 0;
  std::uint64_t moves = 0;  ///< changes of transforms since the structure changed
  std::uint64_t items = 0;  ///< changes of items since the structure changed

  bool operator==(const ListVersion&) const = default;  ///< member by member
};

/// Change log of a DrawList. A producer reports every change or none. A list without a log, such as one that is
/// assembled by hand, is compared entry by entry by its readers. A copy starts without a log, because its owner may
/// change it without reporting.
///
/// Lifetime  spans are valid until the next change is reported.
/// Threads   one thread at a time.
class SIMVIS_API DrawListDelta {
 public:
  DrawListDelta() = default;  ///< without a log
  /// The copy has no log.
  DrawListDelta(const DrawListDelta&) {}
  /// The target has no log afterwards.
  DrawListDelta& operator=(const DrawListDelta&);

  /// Reports a change of the number or order of items, of their materials or transforms, or of the set of materials.
  /// Starts the log.
  void mark_structure_dirty();
  /// Reports that this item shows another mesh, or has become visible or hidden, and nothing else. Requires an earlier
  /// call of mark_structure_dirty() (asserted).
  void mark_item_dirty(std::uint32_t item);
  /// Reports that these entries of world_from_node changed, and nothing else. Requires an earlier call of
  /// mark_structure_dirty() (asserted).
  void mark_transforms_dirty(TransformRange entries);

  bool kept() const { return now_.structure != 0; }  ///< whether there is a log
  ListVersion version() const { return now_; }       ///< the present state

  /// True if only meshes or visibility of items, and values of materials, changed since `seen`. False if that is
  /// unknown.
  bool same_structure(const ListVersion& seen) const { return kept() && seen.structure == now_.structure; }
  /// The items that have changed since `seen`, oldest first; one may occur several times. Empty optional: unknown, any
  /// item may have changed.
  std::optional<std::span<const std::uint32_t>> items_since(const ListVersion& seen) const;
  /// The transforms that have changed since `seen`, oldest first. Empty optional: unknown, anything may have changed.
  std::optional<std::span<const TransformRange>> moved_since(const ListVersion& seen) const;

 private:
  friend const ItemIndex* index_of(const DrawList& list);

  ListVersion now_;
  std::vector<TransformRange> moves_;         // the latest
  std::vector<std::uint32_t> items_;          // the latest changes of items
  mutable std::shared_ptr<ItemIndex> index_;  // made by the first call of index_of()
};

/// An index from transforms to the objects (items or lights) that stand at them.
///
/// Lifetime  returned spans are valid as long as the index.
/// Threads   several threads may read at a time.
class SIMVIS_API StandingAt {
 public:
  StandingAt() = default;  ///< may only be assigned to
  /// Object i stands at transform_of[i], which is below `transforms`.
  StandingAt(std::span<const std::uint32_t> transform_of, std::size_t transforms);

  /// The numbers of the objects at these transforms. Entries at or above `transforms` of the constructor have none.
  std::span<const std::uint32_t> operator[](TransformRange entries) const;

 private:
  std::vector<std::uint32_t> first_, objects_;
};

}  // namespace simvis
