// The tree over items, on the host and on the device, and what the shader reads of each item.
#pragma once

#include <vector>

#include "engine/item_tree.h"
#include "engine/ray_block.h"
#include "engine/ray_mesh_pool.h"

namespace simvis {

class RayTop {
 public:
  explicit RayTop(Device::Impl& device) : device_(device) {}

  /// After items.update() and meshes.update(), whose result `meshes_moved` is. Uploads what has changed.
  void update(const DrawList& list, RayItems& items, const RayMeshPool& meshes, bool meshes_moved, Uploads& uploads);

  /// Over RayItems::items(), one in a leaf.
  const Bvh& bvh() const { return tree_.bvh(); }
  /// Of the items that the shader names, which stand in the order of the tree's leaves.
  std::uint32_t placed(std::uint32_t shader_item) const { return bvh().order[shader_item]; }

  const Buffer& nodes() const { return nodes_; }
  const Buffer& blocks() const { return block_buffer_; }

  /// Forgets everything.
  void clear();

 private:
  void upload_tree(Uploads& uploads);
  void reserve(Buffer& buffer, const char* name, VkDeviceSize size);
  void write_blocks(const DrawList& list, const RayItems& items, const RayMeshPool& meshes, bool all, Uploads& uploads);

  Device::Impl& device_;
  ItemTree tree_;
  std::vector<std::uint32_t> leaf_of_;  // of each item: its place in the tree's order
  std::vector<std::uint8_t> solid_;
  std::vector<shader::RayItem> blocks_;
  Buffer nodes_, block_buffer_;
  bool made_ = false;
};

}  // namespace simvis
