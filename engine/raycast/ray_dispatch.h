// Runs ray_cast.comp: its pipeline, its descriptors, and the buffers of rays and candidates.
#pragma once

#include <array>
#include <span>

#include "engine/vulkan/buffer.h"
#include "engine/vulkan/descriptor_sets.h"
#include "shaders/interop.h"

namespace simvis {

/// The buffers of the world that rays are cast into.
struct RayBuffers {
  const Buffer &top_nodes, &items, &mesh_nodes, &triangles;
};

class RayDispatch {
 public:
  /// Throws MachineError if the device offers a shader too few storage buffers.
  explicit RayDispatch(DeviceImpl& device);

  /// All buffers that it holds. They have no handle before the first cast.
  std::array<const Buffer*, 3> buffers() const { return {&directions_, &candidates_, &readback_}; }

  /// Largest number of rays in one dispatch.
  std::size_t max_rays() const;

  /// Memory for `rays` rays, which the caller fills while no submission is in flight. xyz is the direction, a unit
  /// vector in the world frame. w is a range in metres, rounded down: hits at or before it are skipped. Valid until the
  /// next call.
  std::span<glm::vec4> directions(std::size_t rays);

  /// Records the cast of block.rays.x rays. No submission may be in flight.
  void record(VkCommandBuffer commands, const RayBuffers& buffers, const shader::RayCastBlock& block);

  /// The candidates of each ray, after the submission has finished. Valid until the next directions().
  std::span<const shader::RayCandidates> candidates(std::size_t rays) const;

 private:
  void reserve(Buffer& buffer, const char* name, VkDeviceSize size, VkBufferUsageFlags usage, MemoryKind memory);
  void make_pipeline();
  void describe(const std::array<const Buffer*, SIMVIS_RAY_BINDINGS>& buffers);

  DeviceImpl& device_;
  Handle<VkShaderModule> module_;
  DescriptorLayout set_layout_;
  Handle<VkPipelineLayout> layout_;
  Handle<VkPipeline> pipeline_;
  DescriptorSets set_;
  Buffer directions_, candidates_, readback_;
};

}  // namespace simvis
