// Shader modules and layouts for pipelines of every kind.
#pragma once

#include <cstdint>
#include <span>

#include "engine/vulkan/handle.h"

namespace simvis {

Handle<VkShaderModule> make_module(Device::Impl& device, std::span<const std::uint32_t> words, const char* name);

/// The layout of all pipelines that draw meshes: these sets, and a ViewBlock of push constants.
Handle<VkPipelineLayout> make_mesh_layout(Device::Impl& device, std::span<const VkDescriptorSetLayout> sets,
                                          const char* name);

}  // namespace simvis
