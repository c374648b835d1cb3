// Runs ray_cast.comp: pipeline, descriptors, and the buffers that rays and candidates travel in.
#pragma once

#include <array>
#include <span>

#include "engine/vulkan/buffer.h"
#include "shaders/interop.h"

namespace simvis {

/// What rays are cast into.
struct RayBuffers {
  const Buffer &top_nodes, &items, &mesh_nodes, &triangles;
};

class RayDispatch {
 public:
  /// Throws MachineError where the device offers a shader too few storage buffers.
  explicit RayDispatch(Device::Impl& device);

  /// What it holds; without a handle where nothing was cast yet.
  std::array<const Buffer*, 3> buffers() const { return {&directions_, &candidates_, &readback_}; }

  /// How many rays one dispatch may take.
  std::size_t max_rays() const;

  /// Where the directions of so many rays are to be written while nothing is in flight: xyz, unit vectors in the
  /// world; w, what the ray meets at or before this range it passes, rounded down.
  std::span<glm::vec4> directions(std::size_t rays);

  /// Casts as many rays as `block` says. Nothing is in flight.
  void record(VkCommandBuffer commands, const RayBuffers& buffers, const shader::RayCastBlock& block);

  /// Of each ray, once the submission has finished. Valid until the next directions().
  std::span<const shader::RayCandidates> candidates(std::size_t rays) const;

 private:
  void reserve(Buffer& buffer, const char* name, VkDeviceSize size, VkBufferUsageFlags usage, MemoryKind memory);
  void make_pipeline();
  void make_set();
  void describe(const std::array<const Buffer*, SIMVIS_RAY_BINDINGS>& buffers);

  Device::Impl& device_;
  Handle<VkShaderModule> module_;
  Handle<VkDescriptorSetLayout> set_layout_;
  Handle<VkPipelineLayout> layout_;
  Handle<VkPipeline> pipeline_;
  Handle<VkDescriptorPool> pool_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;  // freed with its pool
  Buffer directions_, candidates_, readback_;
};

}  // namespace simvis
