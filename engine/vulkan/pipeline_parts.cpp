#include "engine/vulkan/pipeline_parts.h"

#include <iterator>

#include "engine/vulkan/device_impl.h"
#include "engine/vulkan/vulkan_check.h"
#include "shaders/interop.h"

namespace simvis {

Handle<VkShaderModule> make_module(DeviceImpl& device, std::span<const std::uint32_t> words, const char* name) {
  const VkShaderModuleCreateInfo info{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                      .pNext = nullptr,
                                      .flags = 0,
                                      .codeSize = words.size_bytes(),
                                      .pCode = words.data()};
  VkShaderModule module = VK_NULL_HANDLE;
  vk_check(vkCreateShaderModule(device.device, &info, nullptr, &module), "vkCreateShaderModule");
  return Handle<VkShaderModule>(device, module, name);
}

Handle<VkPipelineLayout> make_mesh_layout(DeviceImpl& device, std::span<const VkDescriptorSetLayout> sets,
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

VkPipelineShaderStageCreateInfo shader_stage(VkShaderStageFlagBits bit, VkShaderModule module,
                                             const VkSpecializationInfo* constants) {
  return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
          .pNext = nullptr,
          .flags = 0,
          .stage = bit,
          .module = module,
          .pName = "main",
          .pSpecializationInfo = constants};
}

Handle<VkPipeline> make_pipeline(DeviceImpl& device, const GraphicsPipelineDesc& desc, const std::string& name) {
  VkPipelineVertexInputStateCreateInfo input = desc.input;
  input.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
  VkPipelineInputAssemblyStateCreateInfo assembly{};
  assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
  assembly.topology = desc.topology;
  VkPipelineViewportStateCreateInfo viewport{};
  viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
  viewport.viewportCount = viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster = desc.raster;
  raster.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
  raster.lineWidth = 1;
  VkPipelineMultisampleStateCreateInfo multisample{};
  multisample.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
  multisample.rasterizationSamples = static_cast<VkSampleCountFlagBits>(desc.samples);
  VkPipelineDepthStencilStateCreateInfo depth = desc.depth;
  depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
  VkPipelineColorBlendStateCreateInfo blend{};
  blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
  blend.attachmentCount = static_cast<std::uint32_t>(desc.colors.size());
  blend.pAttachments = desc.colors.data();
  const VkDynamicState states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{};
  dynamic.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO;
  dynamic.dynamicStateCount = static_cast<std::uint32_t>(std::size(states));
  dynamic.pDynamicStates = states;

  VkGraphicsPipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
  info.stageCount = static_cast<std::uint32_t>(desc.stages.size());
  info.pStages = desc.stages.data();
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &multisample;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = desc.layout;
  info.renderPass = desc.render_pass;
  VkPipeline pipeline = VK_NULL_HANDLE;
  vk_check(vkCreateGraphicsPipelines(device.device, device.shared->pipeline_cache(), 1, &info, nullptr, &pipeline),
           "vkCreateGraphicsPipelines");
  return Handle<VkPipeline>(device, pipeline, name);
}

Handle<VkPipeline> make_pipeline(DeviceImpl& device, VkShaderModule module, VkPipelineLayout layout,
                                 const std::string& name, const VkSpecializationInfo* constants) {
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage = shader_stage(VK_SHADER_STAGE_COMPUTE_BIT, module, constants);
  info.layout = layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  vk_check(vkCreateComputePipelines(device.device, device.shared->pipeline_cache(), 1, &info, nullptr, &pipeline),
           "vkCreateComputePipelines");
  return Handle<VkPipeline>(device, pipeline, name);
}

}  // namespace simvis
