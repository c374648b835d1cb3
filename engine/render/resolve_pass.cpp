#include "engine/render/resolve_pass.h"

#include <span>

#include "engine/vulkan/pipeline_parts.h"
#include "engine/vulkan/vulkan_check.h"
#include "shaders/interop.h"
#include "shaders/resolve_pass.comp.h"
#include "shaders/resolve_pass_multisampled.comp.h"

namespace simvis {
namespace {

VkImageMemoryBarrier barrier(const GpuImage& image, VkImageLayout from, VkImageLayout to, VkAccessFlags before,
                             VkAccessFlags after) {
  return {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
          .pNext = nullptr,
          .srcAccessMask = before,
          .dstAccessMask = after,
          .oldLayout = from,
          .newLayout = to,
          .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
          .image = image.get(),
          .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
}

}  // namespace

void ResolvePass::make_layouts() {
  const VkDescriptorSetLayoutBinding bindings[] = {
      descriptor_binding(SIMVIS_RESOLVE_SAMPLES, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, VK_SHADER_STAGE_COMPUTE_BIT),
      descriptor_binding(SIMVIS_RESOLVE_MEAN, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, VK_SHADER_STAGE_COMPUTE_BIT)};
  set_layout_ = DescriptorLayout(device_, bindings, "resolve set layout");
  const VkDescriptorSetLayout set_layout = set_layout_.get();
  const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                        .pNext = nullptr,
                                        .flags = 0,
                                        .setLayoutCount = 1,
                                        .pSetLayouts = &set_layout,
                                        .pushConstantRangeCount = 0,
                                        .pPushConstantRanges = nullptr};
  VkPipelineLayout layout = VK_NULL_HANDLE;
  vk_check(vkCreatePipelineLayout(device_.device, &info, nullptr, &layout), "vkCreatePipelineLayout");
  layout_ = Handle<VkPipelineLayout>(device_, layout, "resolve layout");
}

ResolvePass::Binding ResolvePass::bind(const GpuImage& samples, const GpuImage& mean) {
  if (!layout_) make_layouts();
  Binding binding(device_, set_layout_, 1, "resolve set");
  write_descriptor(device_, set_layout_, binding.get(), SIMVIS_RESOLVE_SAMPLES,
                   {VK_NULL_HANDLE, samples.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL});
  write_descriptor(device_, set_layout_, binding.get(), SIMVIS_RESOLVE_MEAN,
                   {VK_NULL_HANDLE, mean.view(), VK_IMAGE_LAYOUT_GENERAL});
  return binding;
}

VkPipeline ResolvePass::pipeline(const Pass& pass) {
  Handle<VkPipeline>& known = pipelines_[pipeline_key(pass)];
  if (known) return known.get();
  const bool multisampled = pass.msaa > 1;
  const std::span<const std::uint32_t> words = multisampled
                                                   ? std::span<const std::uint32_t>(resolve_pass_multisampled_comp)
                                                   : std::span<const std::uint32_t>(resolve_pass_comp);
  const Handle<VkShaderModule> module = make_module(device_, words, "resolve_pass.comp");

  const std::uint32_t values[] = {pass.supersampling, pass.msaa};
  const VkSpecializationMapEntry entries[] = {{SIMVIS_RESOLVE_SUPERSAMPLING, 0, sizeof values[0]},
                                              {SIMVIS_RESOLVE_MSAA, sizeof values[0], sizeof values[0]}};
  const VkSpecializationInfo constants{2, entries, sizeof values, values};
  known = make_pipeline(device_, module.get(), layout_.get(), "mean of " + std::to_string(pass.samples()) + " samples",
                        &constants);
  return known.get();
}

void ResolvePass::record(VkCommandBuffer commands, const Pass& pass, const Binding& binding, const GpuImage& mean) {
  // The old content was read by an earlier submission that has finished.
  const VkImageMemoryBarrier writable =
      barrier(mean, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL, 0, VK_ACCESS_SHADER_WRITE_BIT);
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0, nullptr,
                       0, nullptr, 1, &writable);
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline(pass));
  const VkDescriptorSet set = binding.get();
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, layout_.get(), 0, 1, &set, 0, nullptr);
  const std::uint32_t groups = (pass.width_px + SIMVIS_RESOLVE_GROUP - 1) / SIMVIS_RESOLVE_GROUP;
  vkCmdDispatch(commands, groups, pass.height_px, 1);
  const VkImageMemoryBarrier readable = barrier(mean, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                                VK_ACCESS_SHADER_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT);
  vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0,
                       nullptr, 1, &readable);
}

}  // namespace simvis
