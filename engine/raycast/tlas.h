// The tree over items, on the host and on the device, and the data of each item that the shader reads.
#pragma once

#include <vector>

#include "engine/raycast/blas_pool.h"
#include "engine/raycast/gpu_ray_instance.h"

namespace simvis {

/// Moved items are refitted into the tree. The tree stays correct, but its traversal becomes slower. It is built again
/// when the set of items changes, and when a ray has to visit more than twice as many boxes as when it was built.
class Tlas {
 public:
  explicit Tlas(DeviceImpl& device) : device_(device) {}

  /// Must follow items.update() and meshes.update(); `meshes_moved` is the result of the latter. Uploads the changes.
  void update(const DrawList& list, RayInstances& items, const BlasPool& meshes, bool meshes_moved, Uploads& uploads);

  /// Tree over RayInstances::items(), with one item in each leaf.
  const Bvh& bvh() const { return bvh_; }
  /// Index into RayInstances::items() of an item that the shader names. The shader numbers items in the order of the
  /// tree's leaves.
  std::uint32_t placed(std::uint32_t shader_item) const { return bvh_.order[shader_item]; }

  const Buffer& nodes() const { return nodes_; }
  const Buffer& blocks() const { return block_buffer_; }

  /// Drops the tree and its buffers.
  void clear();

 private:
  // The properties of an item that the shader reads, other than its mesh and its place.
  struct ItemState {
    bool solid = false, has_back = false, visible = false;
    bool operator==(const ItemState&) const = default;
  };
  static ItemState state_of(const DrawList& list, const RayInstance& item);

  void build(RayInstances& items, Uploads& uploads);
  void reserve(Buffer& buffer, const char* name, VkDeviceSize size);
  void write_blocks(const DrawList& list, const RayInstances& items, const BlasPool& meshes, bool all,
                    Uploads& uploads);

  DeviceImpl& device_;
  Bvh bvh_;
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> leaf_of_;  // position of each item in the tree's order
  double sah_cost_when_built_ = 0;
  std::vector<ItemState> states_;
  std::vector<shader::GpuRayInstance> blocks_;
  Buffer nodes_, block_buffer_;
  bool made_ = false;
};

}  // namespace simvis
