// What has changed in a draw list, as its writer tells, so that readers look at that and at nothing else.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace simvis {

class ItemIndex;
struct DrawList;

/// Entries [first, end) of DrawList::world_from_node.
struct TransformRange {
  std::uint32_t first = 0, end = 0;
};

/// Where a reader of a list has come to. The default is nowhere.
struct ListVersion {
  std::uint64_t structure = 0;  ///< of all lists in this process no two have the same; 0: nobody keeps account
  std::uint64_t moves = 0;      ///< ranges that have moved since

  bool operator==(const ListVersion&) const = default;
};

/// Whoever writes a list and tells here what it writes must do so each time. A list of which nobody tells, as one that
/// is put together by hand, is compared by its readers. So is a copy: who has it may write without telling.
class DrawListDelta {
 public:
  DrawListDelta() = default;
  DrawListDelta(const DrawListDelta&) {}
  DrawListDelta& operator=(const DrawListDelta&);

  /// Items, meshes, or which materials there are.
  void mark_structure_dirty();
  /// After the first restructured(): entries of world_from_node, and nothing else.
  void mark_transforms_dirty(TransformRange entries);

  bool kept() const { return now_.structure != 0; }
  ListVersion version() const { return now_; }

  /// Whether items, meshes and the materials' number and order are certainly those that this reader has seen.
  bool same_structure(const ListVersion& seen) const { return kept() && seen.structure == now_.structure; }
  /// What has been written since, oldest first; none where that is not known, so that anything may have been.
  std::optional<std::span<const TransformRange>> moved_since(const ListVersion& seen) const;

 private:
  friend const ItemIndex* index_of(const DrawList& list);

  ListVersion now_;
  std::vector<TransformRange> log_;           // the latest moves
  mutable std::shared_ptr<ItemIndex> index_;  // once somebody has asked
};

/// Numbers of things by the transform at which they stand.
class StandingAt {
 public:
  StandingAt() = default;
  /// Thing i stands at transform_of[i], below `transforms`.
  StandingAt(std::span<const std::uint32_t> transform_of, std::size_t transforms);

  /// At transforms that did not count when this was made nothing stands.
  std::span<const std::uint32_t> operator[](TransformRange entries) const;

 private:
  std::vector<std::uint32_t> first_, things_;
};

}  // namespace simvis
