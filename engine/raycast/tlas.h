// The tree over items, on the host and on the device, and what the shader reads of each item.
#pragma once

#include <vector>

#include "engine/raycast/blas_pool.h"
#include "engine/raycast/gpu_ray_instance.h"

namespace simvis {

/// Items that move are refitted into the tree, which then holds, and gets slower to walk. It is built anew where there
/// are other items, and where a ray has to look into twice as many boxes as when it was built.
class Tlas {
 public:
  explicit Tlas(Device::Impl& device) : device_(device) {}

  /// After items.update() and meshes.update(), whose result `meshes_moved` is. Uploads what has changed.
  void update(const DrawList& list, RayInstances& items, const BlasPool& meshes, bool meshes_moved, Uploads& uploads);

  /// Over RayInstances::items(), one in a leaf.
  const Bvh& bvh() const { return bvh_; }
  /// Of the items that the shader names, which stand in the order of the tree's leaves.
  std::uint32_t placed(std::uint32_t shader_item) const { return bvh_.order[shader_item]; }

  const Buffer& nodes() const { return nodes_; }
  const Buffer& blocks() const { return block_buffer_; }

  /// Forgets everything.
  void clear();

 private:
  void build(RayInstances& items, Uploads& uploads);
  void reserve(Buffer& buffer, const char* name, VkDeviceSize size);
  void write_blocks(const DrawList& list, const RayInstances& items, const BlasPool& meshes, bool all,
                    Uploads& uploads);

  Device::Impl& device_;
  Bvh bvh_;
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> leaf_of_;  // of each item: its place in the tree's order
  double sah_cost_when_built_ = 0;
  std::vector<std::uint8_t> solid_;
  std::vector<shader::RayItem> blocks_;
  Buffer nodes_, block_buffer_;
  bool made_ = false;
};

}  // namespace simvis
