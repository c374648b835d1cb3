// Shader modules, layouts and the creation of pipelines of every kind.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "engine/vulkan/handle.h"

namespace simvis {

Handle<VkShaderModule> make_module(DeviceImpl& device, std::span<const std::uint32_t> words, const char* name);

/// The layout of all pipelines that draw meshes: these sets, and a ViewBlock of push constants.
Handle<VkPipelineLayout> make_mesh_layout(DeviceImpl& device, std::span<const VkDescriptorSetLayout> sets,
                                          const char* name);

/// One shader of a pipeline; its function is main().
VkPipelineShaderStageCreateInfo shader_stage(VkShaderStageFlagBits bit, VkShaderModule module,
                                             const VkSpecializationInfo* constants = nullptr);

/// In what graphics pipelines differ. All of them have one viewport and one scissor, both set while commands are
/// recorded.
struct GraphicsPipelineDesc {
  std::span<const VkPipelineShaderStageCreateInfo> stages;
  VkPipelineVertexInputStateCreateInfo input{};
  VkPrimitiveTopology topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineRasterizationStateCreateInfo raster{};
  std::uint32_t samples = 1;  ///< per pixel
  VkPipelineDepthStencilStateCreateInfo depth{};
  std::span<const VkPipelineColorBlendAttachmentState> colors;  ///< of each colour target
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkRenderPass render_pass = VK_NULL_HANDLE;
};

/// Fills in the sType of `input`, `raster` and `depth`, and the width of lines. Everything that the description refers
/// to is needed during the call only.
Handle<VkPipeline> make_pipeline(DeviceImpl& device, const GraphicsPipelineDesc& desc, const std::string& name);

/// A pipeline of one compute shader.
Handle<VkPipeline> make_pipeline(DeviceImpl& device, VkShaderModule module, VkPipelineLayout layout,
                                 const std::string& name, const VkSpecializationInfo* constants = nullptr);

}  // namespace simvis
