#include "engine/frame_buffers.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "engine/error.h"
#include "engine/vulkan_check.h"

namespace simvis {
namespace {

constexpr const char* kNames[] = {"instances", "materials", "lights"};  // by binding
constexpr VkDeviceSize kFirstSize = 16384;
// What a blended texel needs to be seen by depth, see Material.
constexpr float kBlendCutoff = 0.5f;

shader::MaterialBlock block_of(const Material& m) {
  const auto& t = m.uv_transform;
  return {.base_color = m.base_color,
          .emissive_cutoff = glm::vec4(m.emissive, m.alpha_mode == AlphaMode::blend ? kBlendCutoff : m.alpha_cutoff),
          .uv_row_u = {t[0][0], t[1][0], t[2][0], m.uv_set},
          .uv_row_v = {t[0][1], t[1][1], t[2][1], 0}};
}

}  // namespace

FrameBuffers::FrameBuffers(Device::Impl& device, VkDescriptorSetLayout set_layout) : device_(device) {
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 3};
  const VkDescriptorPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .pNext = nullptr,
                                             .flags = 0,
                                             .maxSets = 1,
                                             .poolSizeCount = 1,
                                             .pPoolSizes = &size};
  VkDescriptorPool pool = VK_NULL_HANDLE;
  vk_check(vkCreateDescriptorPool(device.device, &pool_info, nullptr, &pool), "vkCreateDescriptorPool");
  pool_ = Handle<VkDescriptorPool>(device, pool, "frame set");
  const VkDescriptorSetAllocateInfo allocation{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                               .pNext = nullptr,
                                               .descriptorPool = pool,
                                               .descriptorSetCount = 1,
                                               .pSetLayouts = &set_layout};
  vk_check(vkAllocateDescriptorSets(device.device, &allocation, &set_), "vkAllocateDescriptorSets");
  for (const std::uint32_t binding : {SIMVIS_INSTANCES, SIMVIS_MATERIALS, SIMVIS_LIGHTS}) reserve(binding, 1);
}

bool FrameBuffers::reserve(std::uint32_t binding, VkDeviceSize size) {
  Buffer& buffer = buffers_[binding];
  if (buffer && size <= buffer.size()) return false;
  const VkDeviceSize limit = device_.limits().maxStorageBufferRange;
  if (size > limit) {
    throw MachineError(std::string("a frame needs ") + std::to_string(size) + " bytes of " + kNames[binding] + "; " +
                       device_.physical.info.name + " allows " + std::to_string(limit));
  }
  const VkDeviceSize grown = std::min(limit, std::max({kFirstSize, size, 2 * buffer.size()}));
  buffer = Buffer(device_, {.name = kNames[binding],
                            .size = grown,
                            .usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT,
                            .memory = MemoryKind::dynamic});
  const VkDescriptorBufferInfo info{.buffer = buffer.get(), .offset = 0, .range = VK_WHOLE_SIZE};
  VkWriteDescriptorSet write{};
  write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
  write.dstSet = set_;
  write.dstBinding = binding;
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  write.pBufferInfo = &info;
  vkUpdateDescriptorSets(device_.device, 1, &write, 0, nullptr);
  return true;
}

void FrameBuffers::write(std::uint32_t binding, std::span<const std::byte> data, Uploads& uploads) {
  if (data.empty()) return;
  reserve(binding, data.size());
  uploads.write(buffers_[binding], 0, data);
}

void FrameBuffers::write_instances(std::span<const shader::Instance> instances, Uploads& uploads) {
  write(SIMVIS_INSTANCES, std::as_bytes(instances), uploads);
}

void FrameBuffers::write_lights(std::span<const shader::LightBlock> lights, Uploads& uploads) {
  write(SIMVIS_LIGHTS, std::as_bytes(lights), uploads);
}

void FrameBuffers::write_materials(const DrawList& list, std::span<const std::uint8_t> wanted, Uploads& uploads) {
  if (reserve(SIMVIS_MATERIALS, list.materials.size() * sizeof(shader::MaterialBlock))) slots_.clear();
  slots_.resize(list.materials.size());
  for (std::size_t m = 0; m < slots_.size(); ++m) {
    Slot& slot = slots_[m];
    if (!wanted[m] || (slot.material == list.materials[m] && slot.revision == list.material_revision[m])) continue;
    const shader::MaterialBlock block = block_of(*list.materials[m]);
    uploads.write(buffers_[SIMVIS_MATERIALS], m * sizeof block, std::as_bytes(std::span(&block, 1)));
    slot = {list.materials[m], list.material_revision[m]};
  }
}

}  // namespace simvis
