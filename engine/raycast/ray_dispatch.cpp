#include "engine/raycast/ray_dispatch.h"

#include <algorithm>
#include <string>

#include <simvis/error.h>
#include "engine/base/assert.h"
#include "engine/vulkan/pipeline_parts.h"
#include "engine/vulkan/vulkan_check.h"
#include "shaders/ray_cast.comp.h"

namespace simvis {

namespace {

constexpr VkDeviceSize kFirstSize = 16384;
// A larger dispatch is not faster and takes more memory.
constexpr std::size_t kMaxRays = std::size_t{1} << 20;

void check_limits(const DeviceImpl& device) {
  const std::uint32_t offered = device.limits().maxPerStageDescriptorStorageBuffers;
  if (offered >= SIMVIS_RAY_BINDINGS) return;
  throw MachineError("rays cannot be cast: that takes " + std::to_string(SIMVIS_RAY_BINDINGS) +
                     " storage buffers of a shader, and " + device.physical.info.name + " offers " +
                     std::to_string(offered));
}

void barrier(VkCommandBuffer commands, VkPipelineStageFlags from, VkAccessFlags written, VkPipelineStageFlags to,
             VkAccessFlags read) {
  const VkMemoryBarrier memory{
      .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER, .pNext = nullptr, .srcAccessMask = written, .dstAccessMask = read};
  vkCmdPipelineBarrier(commands, from, to, 0, 1, &memory, 0, nullptr, 0, nullptr);
}

}  // namespace

RayDispatch::RayDispatch(DeviceImpl& device) : device_(device) {
  check_limits(device);
  make_pipeline();
  set_ = DescriptorSets(device, set_layout_, 1, "ray set");
}

void RayDispatch::make_pipeline() {
  module_ = make_module(device_, ray_cast_comp, "ray_cast.comp");
  std::array<VkDescriptorSetLayoutBinding, SIMVIS_RAY_BINDINGS> bindings;
  for (std::uint32_t i = 0; i < SIMVIS_RAY_BINDINGS; ++i) {
    bindings[i] = descriptor_binding(i, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, VK_SHADER_STAGE_COMPUTE_BIT);
  }
  set_layout_ = DescriptorLayout(device_, bindings, "ray set layout");
  const VkDescriptorSetLayout set_layout = set_layout_.get();
  const VkPushConstantRange constants{
      .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .offset = 0, .size = sizeof(shader::RayCastBlock)};
  const VkPipelineLayoutCreateInfo layout_info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .pNext = nullptr,
                                               .flags = 0,
                                               .setLayoutCount = 1,
                                               .pSetLayouts = &set_layout,
                                               .pushConstantRangeCount = 1,
                                               .pPushConstantRanges = &constants};
  VkPipelineLayout layout = VK_NULL_HANDLE;
  vk_check(vkCreatePipelineLayout(device_.device, &layout_info, nullptr, &layout), "vkCreatePipelineLayout");
  layout_ = Handle<VkPipelineLayout>(device_, layout, "ray pipeline layout");
  pipeline_ = simvis::make_pipeline(device_, module_.get(), layout, "ray pipeline");
}

std::size_t RayDispatch::max_rays() const {
  const VkPhysicalDeviceLimits& limits = device_.limits();
  return std::min({kMaxRays, std::size_t{limits.maxStorageBufferRange} / sizeof(shader::RayCandidates),
                   std::size_t{limits.maxComputeWorkGroupCount[0]} * SIMVIS_RAY_GROUP});
}

std::span<glm::vec4> RayDispatch::directions(std::size_t rays) {
  SIMVIS_ASSERT(rays > 0 && rays <= max_rays());
  reserve(directions_, "ray directions", rays * sizeof(glm::vec4), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
          MemoryKind::dynamic);
  const VkDeviceSize size = rays * sizeof(shader::RayCandidates);
  reserve(candidates_, "ray candidates", size, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
          MemoryKind::device);
  reserve(readback_, "ray readback", size, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryKind::readback);
  return {reinterpret_cast<glm::vec4*>(directions_.mapped()), rays};
}

void RayDispatch::reserve(Buffer& buffer, const char* name, VkDeviceSize size, VkBufferUsageFlags usage,
                          MemoryKind memory) {
  if (buffer && buffer.size() >= size) return;
  const VkDeviceSize most = std::max<VkDeviceSize>(size, device_.limits().maxStorageBufferRange);
  buffer = Buffer(
      device_,
      {.name = name, .size = std::min(most, std::max(kFirstSize, size + size / 2)), .usage = usage, .memory = memory});
}

// No submission is in flight, so the set may be written.
void RayDispatch::describe(const std::array<const Buffer*, SIMVIS_RAY_BINDINGS>& buffers) {
  for (std::uint32_t i = 0; i < SIMVIS_RAY_BINDINGS; ++i) {
    write_descriptor(device_, set_layout_, set_.get(), i,
                     {.buffer = buffers[i]->get(), .offset = 0, .range = buffers[i]->size()});
  }
}

void RayDispatch::record(VkCommandBuffer commands, const RayBuffers& buffers, const shader::RayCastBlock& block) {
  std::array<const Buffer*, SIMVIS_RAY_BINDINGS> bound;
  bound[SIMVIS_RAY_TOP_NODES] = &buffers.top_nodes;
  bound[SIMVIS_RAY_ITEMS] = &buffers.items;
  bound[SIMVIS_RAY_MESH_NODES] = &buffers.mesh_nodes;
  bound[SIMVIS_RAY_TRIANGLES] = &buffers.triangles;
  bound[SIMVIS_RAY_DIRECTIONS] = &directions_;
  bound[SIMVIS_RAY_CANDIDATES] = &candidates_;
  describe(bound);
  device_.begin_label(commands, "rays");
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_.get());
  const VkDescriptorSet set = set_.get();
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set, 0, nullptr);
  vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof block, &block);
  vkCmdDispatch(commands, (block.rays.x + SIMVIS_RAY_GROUP - 1) / SIMVIS_RAY_GROUP, 1, 1);
  barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
          VK_ACCESS_TRANSFER_READ_BIT);
  const VkBufferCopy region{.srcOffset = 0, .dstOffset = 0, .size = block.rays.x * sizeof(shader::RayCandidates)};
  vkCmdCopyBuffer(commands, candidates_.get(), readback_.get(), 1, &region);
  barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
          VK_ACCESS_HOST_READ_BIT);
  device_.end_label(commands);
}

std::span<const shader::RayCandidates> RayDispatch::candidates(std::size_t rays) const {
  return {reinterpret_cast<const shader::RayCandidates*>(readback_.mapped()), rays};
}

}  // namespace simvis
