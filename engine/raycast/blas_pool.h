// The trees and triangles of all meshes that rays can hit, in two device buffers.
#pragma once

#include <unordered_map>

#include "engine/raycast/ray_instances.h"
#include "engine/vulkan/uploads.h"

namespace simvis {

/// Meshes are identified by address, uploaded once, and dropped when no item uses them. The buffers are filled from the
/// front. When the end is reached, the meshes in use are copied to the front of new buffers, within the device.
class BlasPool {
 public:
  explicit BlasPool(DeviceImpl& device) : device_(device) {}

  /// Makes the meshes of the items resident. Returns true if meshes that were resident before may have moved. Throws
  /// MachineError if a buffer would exceed the device's maxStorageBufferRange.
  bool update(const RayInstances& items, Uploads& uploads);

  struct Place {
    std::uint32_t first_node = 0, first_triangle = 0;
  };
  Place place(const Blas& mesh) const;

  /// The buffers have no handle before the first item.
  const Buffer& nodes() const { return nodes_; }
  const Buffer& triangles() const { return triangles_; }

  /// Drops all meshes and both buffers.
  void clear();

 private:
  struct Entry {
    std::shared_ptr<const Mesh> mesh;  // keeps the address from being reused by another mesh
    std::uint64_t nodes = 0, triangles = 0;
    std::uint64_t first_node = 0, first_triangle = 0;
    bool resident = false, wanted = false;
  };
  bool make_room(std::uint64_t nodes, std::uint64_t triangles, Uploads& uploads);
  void upload(const Blas& mesh, const Bvh& tree, Entry& entry, Uploads& uploads);
  std::uint64_t capacity(std::uint64_t needed, std::uint64_t stride) const;

  DeviceImpl& device_;
  Buffer nodes_, triangles_;
  std::uint64_t node_capacity_ = 0, triangle_capacity_ = 0;
  std::uint64_t nodes_used_ = 0, triangles_used_ = 0;
  std::unordered_map<const Mesh*, Entry> entries_;
};

}  // namespace simvis
