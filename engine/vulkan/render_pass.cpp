#include "engine/vulkan/render_pass.h"

#include "engine/vulkan/formats.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

VkAttachmentDescription depth_attachment(const RenderPassKind& kind) {
  VkAttachmentDescription depth{};
  depth.format = kDepthFormat;
  depth.samples = static_cast<VkSampleCountFlagBits>(kind.samples);
  depth.loadOp = kind.resumed ? VK_ATTACHMENT_LOAD_OP_LOAD : VK_ATTACHMENT_LOAD_OP_CLEAR;
  depth.storeOp = kind.keep_depth || kind.continued || kind.sampled ? VK_ATTACHMENT_STORE_OP_STORE
                                                                    : VK_ATTACHMENT_STORE_OP_DONT_CARE;
  depth.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  depth.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  depth.initialLayout = !kind.resumed  ? VK_IMAGE_LAYOUT_UNDEFINED
                        : kind.sampled ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL
                                       : VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  depth.finalLayout = kind.sampled                         ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL
                      : kind.keep_depth && !kind.continued ? VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL
                                                           : VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
  return depth;
}

// The target of colour or of items.
VkAttachmentDescription color_attachment(const RenderPassKind& kind) {
  VkAttachmentDescription color = depth_attachment(kind);
  color.format = kind.items ? kItemFormat : kColorFormat;
  color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  color.initialLayout = kind.resumed ? VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED;
  color.finalLayout = kind.continued  ? VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL
                      : kind.averaged ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL
                                      : VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  return color;
}

// The pass waits for no earlier commands: the host waits for each frame, and a pass that is resumed within a frame
// waits by a barrier (see OitBuffer). The copies and the ResolvePass after it wait by this dependency. It is the same
// for all passes that are not `sampled`, because compatible passes need equal dependencies.
VkSubpassDependency dependency_after(const RenderPassKind& kind) {
  VkSubpassDependency used{};
  used.srcSubpass = 0;
  used.dstSubpass = VK_SUBPASS_EXTERNAL;
  used.srcStageMask = VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                      VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  used.dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
  used.srcAccessMask = VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  used.dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_SHADER_READ_BIT;
  if (kind.sampled) {
    used.dstStageMask = VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT;
    used.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
  }
  return used;
}

}  // namespace

Handle<VkRenderPass> make_render_pass(DeviceImpl& device, const RenderPassKind& kind) {
  const VkAttachmentDescription attachments[] = {depth_attachment(kind), color_attachment(kind)};
  const VkAttachmentReference depth_reference{0, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference color_reference{1, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = kind.color || kind.items ? 1 : 0;
  subpass.pColorAttachments = &color_reference;
  subpass.pDepthStencilAttachment = &depth_reference;

  const VkSubpassDependency used = dependency_after(kind);
  VkRenderPassCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO;
  info.attachmentCount = 1 + subpass.colorAttachmentCount;
  info.pAttachments = attachments;
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = 1;
  info.pDependencies = &used;
  VkRenderPass pass = VK_NULL_HANDLE;
  vk_check(vkCreateRenderPass(device.device, &info, nullptr, &pass), "vkCreateRenderPass");
  return Handle<VkRenderPass>(device, pass,
                              kind.color   ? "colour and depth pass"
                              : kind.items ? "item and depth pass"
                                           : "depth pass");
}

}  // namespace simvis
