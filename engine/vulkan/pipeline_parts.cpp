#include "engine/vulkan/pipeline_parts.h"

#include "engine/vulkan/vulkan_check.h"
#include "shaders/interop.h"

namespace simvis {

Handle<VkShaderModule> make_module(Device::Impl& device, std::span<const std::uint32_t> words, const char* name) {
  const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                      .pNext = nullptr,
                                      .flags = 0,
                                      .codeSize = words.size_bytes(),
                                      .pCode = words.data()};
  VkShaderModule module = VK_NULL_HANDLE;
  vk_check(vkCreateShaderModule(device.device, &info, nullptr, &module), "vkCreateShaderModule");
  return Handle<VkShaderModule>(device, module, name);
}

Handle<VkPipelineLayout> make_mesh_layout(Device::Impl& device, std::span<const VkDescriptorSetLayout> sets,
                                          const char* name) {
  const VkPushConstantRange constants{.stageFlags = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT,
                                      .offset = 0,
                                      .size = sizeof(shader::ViewBlock)};
  const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                        .pNext = nullptr,
                                        .flags = 0,
                                        .setLayoutCount = static_cast<std::uint32_t>(sets.size()),
                                        .pSetLayouts = sets.data(),
                                        .pushConstantRangeCount = 1,
                                        .pPushConstantRanges = &constants};
  VkPipelineLayout layout = VK_NULL_HANDLE;
  vk_check(vkCreatePipelineLayout(device.device, &info, nullptr, &layout), "vkCreatePipelineLayout");
  return Handle<VkPipelineLayout>(device, layout, name);
}

}  // namespace simvis
