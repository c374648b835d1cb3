// Descriptor sets with their layouts, their pools, and the buffers and images that they refer to.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <span>
#include <vector>

#include "engine/vulkan/handle.h"

namespace simvis {

VkDescriptorSetLayoutBinding descriptor_binding(std::uint32_t binding, VkDescriptorType type,
                                                VkShaderStageFlags stages);

/// The descriptors of a set: binding i is bindings[i], a single descriptor.
class DescriptorLayout {
 public:
  DescriptorLayout() = default;
  DescriptorLayout(DeviceImpl& device, std::span<const VkDescriptorSetLayoutBinding> bindings, const char* name);

  VkDescriptorSetLayout get() const { return layout_.get(); }
  std::span<const VkDescriptorType> types() const { return types_; }  ///< type of each binding
  explicit operator bool() const { return static_cast<bool>(layout_); }

 private:
  Handle<VkDescriptorSetLayout> layout_;
  std::vector<VkDescriptorType> types_;
};

/// Sets of one layout and the pool that holds only these sets. Sets and pool are freed together.
class DescriptorSets {
 public:
  DescriptorSets() = default;
  /// `count` is above 0.
  DescriptorSets(DeviceImpl& device, const DescriptorLayout& layout, std::uint32_t count, const char* name);

  VkDescriptorSet get() const { return sets_.front(); }
  std::span<const VkDescriptorSet> all() const { return sets_; }
  explicit operator bool() const { return static_cast<bool>(pool_); }

 private:
  Handle<VkDescriptorPool> pool_;
  std::vector<VkDescriptorSet> sets_;  // freed with their pool
};

/// Points one descriptor of a set at a buffer, an image or a texel buffer. No submission in flight may use the set.
void write_descriptor(const DeviceImpl& device, const DescriptorLayout& layout, VkDescriptorSet set,
                      std::uint32_t binding, const VkDescriptorBufferInfo& buffer);
void write_descriptor(const DeviceImpl& device, const DescriptorLayout& layout, VkDescriptorSet set,
                      std::uint32_t binding, const VkDescriptorImageInfo& image);
void write_descriptor(const DeviceImpl& device, const DescriptorLayout& layout, VkDescriptorSet set,
                      std::uint32_t binding, VkBufferView texels);

}  // namespace simvis
