#include "engine/vulkan/descriptor_sets.h"

#include "engine/base/assert.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

void write_descriptor(const DeviceImpl& device, const DescriptorLayout& layout, VkDescriptorSet set,
                      std::uint32_t binding, const VkDescriptorBufferInfo* buffer, const VkDescriptorImageInfo* image,
                      const VkBufferView* texels) {
  SIMVIS_ASSERT(binding < layout.types().size());
  const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                   .pNext = nullptr,
                                   .dstSet = set,
                                   .dstBinding = binding,
                                   .dstArrayElement = 0,
                                   .descriptorCount = 1,
                                   .descriptorType = layout.types()[binding],
                                   .pImageInfo = image,
                                   .pBufferInfo = buffer,
                                   .pTexelBufferView = texels};
  vkUpdateDescriptorSets(device.device, 1, &write, 0, nullptr);
}

}  // namespace

VkDescriptorSetLayoutBinding descriptor_binding(std::uint32_t binding, VkDescriptorType type,
                                                VkShaderStageFlags stages) {
  return {.binding = binding,
          .descriptorType = type,
          .descriptorCount = 1,
          .stageFlags = stages,
          .pImmutableSamplers = nullptr};
}

DescriptorLayout::DescriptorLayout(DeviceImpl& device, std::span<const VkDescriptorSetLayoutBinding> bindings,
                                   const char* name) {
  for (const VkDescriptorSetLayoutBinding& binding : bindings) {
    SIMVIS_ASSERT(binding.binding == types_.size() && binding.descriptorCount == 1);
    types_.push_back(binding.descriptorType);
  }
  const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                             .pNext = nullptr,
                                             .flags = 0,
                                             .bindingCount = static_cast<std::uint32_t>(bindings.size()),
                                             .pBindings = bindings.data()};
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  vk_check(vkCreateDescriptorSetLayout(device.device, &info, nullptr, &layout), "vkCreateDescriptorSetLayout");
  layout_ = Handle<VkDescriptorSetLayout>(device, layout, name);
}

DescriptorSets::DescriptorSets(DeviceImpl& device, const DescriptorLayout& layout, std::uint32_t count,
                               const char* name)
    : sets_(count) {
  SIMVIS_ASSERT(count > 0);
  std::vector<VkDescriptorPoolSize> sizes;
  for (const VkDescriptorType type : layout.types()) sizes.push_back({type, count});  // a type may occur several times
  const VkDescriptorPoolCreateInfo pool_info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .pNext = nullptr,
                                             .flags = 0,
                                             .maxSets = count,
                                             .poolSizeCount = static_cast<std::uint32_t>(sizes.size()),
                                             .pPoolSizes = sizes.data()};
  VkDescriptorPool pool = VK_NULL_HANDLE;
  vk_check(vkCreateDescriptorPool(device.device, &pool_info, nullptr, &pool), "vkCreateDescriptorPool");
  pool_ = Handle<VkDescriptorPool>(device, pool, name);
  const std::vector<VkDescriptorSetLayout> layouts(count, layout.get());
  const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                         .pNext = nullptr,
                                         .descriptorPool = pool,
                                         .descriptorSetCount = count,
                                         .pSetLayouts = layouts.data()};
  vk_check(vkAllocateDescriptorSets(device.device, &info, sets_.data()), "vkAllocateDescriptorSets");
}

void write_descriptor(const DeviceImpl& device, const DescriptorLayout& layout, VkDescriptorSet set,
                      std::uint32_t binding, const VkDescriptorBufferInfo& buffer) {
  write_descriptor(device, layout, set, binding, &buffer, nullptr, nullptr);
}

void write_descriptor(const DeviceImpl& device, const DescriptorLayout& layout, VkDescriptorSet set,
                      std::uint32_t binding, const VkDescriptorImageInfo& image) {
  write_descriptor(device, layout, set, binding, nullptr, &image, nullptr);
}

void write_descriptor(const DeviceImpl& device, const DescriptorLayout& layout, VkDescriptorSet set,
                      std::uint32_t binding, VkBufferView texels) {
  write_descriptor(device, layout, set, binding, nullptr, nullptr, &texels);
}

}  // namespace simvis
