#include "engine/raycast/tlas.h"

#include <algorithm>
#include <string>

#include <simvis/error.h>
#include "engine/draw/surface_alpha.h"

namespace simvis {

namespace {

constexpr VkDeviceSize kFirstTopSize = 4096;

/// Uploads the entries of a table that have the given indices, in ascending order. Adjacent entries are uploaded
/// together.
template <typename T>
void write_entries(const Buffer& buffer, std::span<const T> table, std::span<const std::uint32_t> entries,
                   Uploads& uploads) {
  for (std::size_t i = 0; i < entries.size();) {
    std::size_t end = i + 1;
    while (end < entries.size() && entries[end] == entries[end - 1] + 1) ++end;
    uploads.write(buffer, entries[i] * sizeof(T), std::as_bytes(table.subspan(entries[i], end - i)));
    i = end;
  }
}

}  // namespace

void Tlas::update(const DrawList& list, RayInstances& items, const BlasPool& meshes, bool meshes_moved,
                  Uploads& uploads) {
  const bool rebuilt = !made_ || items.structure_changed();
  bool reordered = rebuilt;
  if (rebuilt) {
    made_ = false;
    boxes_.clear();
    states_.clear();
    for (const RayInstance& item : items.items()) {
      boxes_.push_back(item.box);
      states_.push_back(state_of(list, item));
    }
    build(items, uploads);
  } else if (!items.moved_items().empty()) {
    for (const std::uint32_t i : items.moved_items()) boxes_[i] = items.items()[i].box;
    const std::vector<std::uint32_t> changed = refit(bvh_, boxes_);
    ++items.counters.item_trees_refitted;
    reordered = sah_cost(bvh_) > kMaxSahCostRatio * sah_cost_when_built_;
    if (reordered) {
      build(items, uploads);
    } else {
      write_entries(nodes_, std::span<const BvhNode>(bvh_.nodes), changed, uploads);
    }
  }
  write_blocks(list, items, meshes, reordered || meshes_moved, uploads);
  made_ = true;
}

void Tlas::build(RayInstances& items, Uploads& uploads) {
  bvh_ = build_bvh(boxes_, 1, 1, &items.threads());
  sah_cost_when_built_ = sah_cost(bvh_);
  leaf_of_.resize(boxes_.size());
  for (std::uint32_t i = 0; i < bvh_.order.size(); ++i) leaf_of_[bvh_.order[i]] = i;
  ++items.counters.item_trees_built;
  if (boxes_.empty()) return;
  reserve(nodes_, "ray top nodes", bvh_.nodes.size() * sizeof(BvhNode));
  reserve(block_buffer_, "ray items", boxes_.size() * sizeof(shader::GpuRayInstance));
  uploads.write(nodes_, 0, std::as_bytes(std::span(bvh_.nodes)));
}

// Nothing behind an item that is solid at every point needs a test.
Tlas::ItemState Tlas::state_of(const DrawList& list, const RayInstance& item) {
  const Material& material = *list.materials[list.items[item.item].material];
  return {.solid = is_solid_throughout(material),
          .has_back = has_back(material, *item.mesh->mesh()),
          .visible = item.visible};
}

// Checks all items, because a material or a visibility may change although no item moves.
void Tlas::write_blocks(const DrawList& list, const RayInstances& items, const BlasPool& meshes, bool all,
                        Uploads& uploads) {
  std::vector<std::uint32_t> leaves;
  const auto add = [&](std::uint32_t i) { leaves.push_back(leaf_of_[i]); };
  for (std::uint32_t i = 0; i < states_.size(); ++i) {
    const ItemState state = state_of(list, items.items()[i]);
    if (all || state != states_[i]) add(i);
    states_[i] = state;
  }
  if (!all) std::ranges::for_each(items.moved_items(), add);
  std::ranges::sort(leaves);
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
  blocks_.resize(states_.size());
  for (const std::uint32_t leaf : leaves) {
    const std::uint32_t i = placed(leaf);
    const BlasPool::Place place = meshes.place(*items.items()[i].mesh);
    blocks_[leaf] = block_of(items.items()[i], items.origin(),
                             {place.first_node, place.first_triangle, states_[i].solid, states_[i].has_back});
  }
  write_entries(block_buffer_, std::span<const shader::GpuRayInstance>(blocks_), leaves, uploads);
}

void Tlas::reserve(Buffer& buffer, const char* name, VkDeviceSize size) {
  const VkDeviceSize most = device_.limits().maxStorageBufferRange;
  if (size > most) {
    throw MachineError("rays cannot be cast: the scene's items need a buffer of " + std::to_string(size) +
                       " bytes, and " + device_.physical.info.name + " addresses " + std::to_string(most));
  }
  if (buffer && buffer.size() >= size) return;
  buffer = Buffer(device_, {.name = name,
                            .size = std::min(most, std::max(kFirstTopSize, size + size / 2)),
                            .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                            .memory = MemoryKind::device});
}

void Tlas::clear() {
  bvh_ = {};
  nodes_ = {};
  block_buffer_ = {};
  made_ = false;
}

}  // namespace simvis
