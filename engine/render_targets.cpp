#include "engine/render_targets.h"

#include "engine/formats.h"
#include "engine/vulkan_check.h"

namespace simvis {
namespace {

// A sensor that fires at 1 Hz among others at 100 Hz keeps its targets.
constexpr std::uint64_t kFramesKept = 256;

Buffer make_readback(Device::Impl& device, const RenderTarget& target, VkDeviceSize bytes_per_pixel, const char* name) {
  return Buffer(device, {.name = name,
                         .size = VkDeviceSize{target.width} * target.height * bytes_per_pixel,
                         .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                         .memory = MemoryKind::readback});
}

}  // namespace

void RenderTargets::begin_frame() {
  ++frame_;
  std::erase_if(targets_, [this](const auto& target) { return target->last_frame + kFramesKept < frame_; });
}

RenderTarget& RenderTargets::acquire(const Pass& pass) {
  RenderTarget* target = nullptr;
  for (const auto& known : targets_) {
    const bool fits = known->width == pass.width_px && known->height == pass.height_px &&
                      static_cast<bool>(known->color) == pass.color;
    if (fits && known->last_frame != frame_) {
      target = known.get();
      break;
    }
  }
  if (!target) target = targets_.emplace_back(make(pass)).get();
  target->last_frame = frame_;
  if (pass.depth && !target->depth_readback) {
    target->depth_readback = make_readback(device_, *target, sizeof(float), "depth readback");
  }
  if (pass.color && !target->color_readback) {
    target->color_readback = make_readback(device_, *target, 4 * sizeof(float), "colour readback");
  }
  return *target;
}

std::unique_ptr<RenderTarget> RenderTargets::make(const Pass& pass) const {
  auto target = std::make_unique<RenderTarget>();
  target->width = pass.width_px;
  target->height = pass.height_px;
  target->depth =
      GpuImage(device_, {.name = pass.name + "/depth",
                         .width = pass.width_px,
                         .height = pass.height_px,
                         .format = kDepthFormat,
                         .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                         .aspect = VK_IMAGE_ASPECT_DEPTH_BIT});
  if (pass.color) {
    target->color = GpuImage(device_, {.name = pass.name + "/colour",
                                       .width = pass.width_px,
                                       .height = pass.height_px,
                                       .format = kColorFormat,
                                       .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
  }
  const VkImageView views[] = {target->depth.view(), target->color.view()};
  const VkFramebufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .pNext = nullptr,
                                     .flags = 0,
                                     .renderPass = pipelines_.render_pass(pass.color, true),
                                     .attachmentCount = pass.color ? 2u : 1u,
                                     .pAttachments = views,
                                     .width = pass.width_px,
                                     .height = pass.height_px,
                                     .layers = 1};
  VkFramebuffer framebuffer = VK_NULL_HANDLE;
  vk_check(vkCreateFramebuffer(device_.device, &info, nullptr, &framebuffer), "vkCreateFramebuffer");
  target->framebuffer = Handle<VkFramebuffer>(device_, framebuffer, pass.name + " framebuffer");
  return target;
}

}  // namespace simvis
