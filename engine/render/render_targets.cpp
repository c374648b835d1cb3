#include "engine/render/render_targets.h"

#include <algorithm>

#include "engine/vulkan/formats.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

// Large enough that a sensor at 1 Hz keeps its targets while other sensors fire at 100 Hz.
constexpr std::uint64_t kFramesKept = 256;

Buffer make_readback(DeviceImpl& device, const RenderTarget& target, VkDeviceSize bytes_per_pixel, const char* name) {
  return Buffer(device, {.name = name,
                         .size = VkDeviceSize{target.width} * target.height * bytes_per_pixel,
                         .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                         .memory = MemoryKind::readback});
}

bool fits(const RenderTarget& target, const Pass& pass) {
  return target.width == pass.width_px && target.height == pass.height_px &&
         target.supersampling == pass.supersampling && target.msaa == pass.msaa &&
         target.shadow_maps == pass.shadow_maps && static_cast<bool>(target.color) == pass.color &&
         static_cast<bool>(target.items) == pass.has_item_target();
}

}  // namespace

void RenderTargets::begin_frame() {
  ++frame_;
  std::erase_if(targets_, [this](const auto& target) { return target->last_frame + kFramesKept < frame_; });
}

RenderTarget& RenderTargets::acquire(const Pass& pass) {
  const auto known = std::ranges::find_if(
      targets_, [&](const auto& target) { return target->last_frame != frame_ && fits(*target, pass); });
  RenderTarget* target = nullptr;
  if (known != targets_.end()) {
    target = known->get();
  } else {
    target = targets_.emplace_back(make(pass)).get();
    target->number = ++made_;
  }
  target->last_frame = frame_;
  if (pass.depth && !target->depth_readback) {
    target->depth_readback = make_readback(device_, *target, sizeof(float), "depth readback");
  }
  if (pass.color && !target->color.pixels() && !target->color_readback) {
    target->color_readback = make_readback(device_, *target, 4 * sizeof(float), "colour readback");
  }
  if (pass.has_item_target() && !target->items.pixels() && !target->items_readback) {
    target->items_readback = make_readback(device_, *target, kItemTexelBytes, "item readback");
  }
  return *target;
}

void RenderTargets::name_memory(const std::function<const Pass*(const RenderTarget&)>& user,
                                std::vector<PlannedMemory>& memory) const {
  for (const auto& target : targets_) {
    const Pass* const pass = user(*target);
    const auto add = [&](const std::string& name, std::uint64_t bytes, const char* what) {
      if (bytes == 0) return;
      const std::string size = std::to_string(target->width) + " x " + std::to_string(target->height);
      memory.push_back({pass != nullptr ? pass->name + "/" + name : name,
                        pass != nullptr ? what : "kept for a pass of " + size + " that is not in this frame", bytes,
                        0});
    };
    add("depth", target->depth.memory_bytes(), "visibility");
    add("colour samples", target->color_samples.memory_bytes(), "several samples of each pixel");
    add("colour", target->color.memory_bytes(), "colour is asked for");
    add("items", target->items.memory_bytes(), "items are asked for");
    add("depth readback", target->depth_readback.memory_bytes(), "depth is asked for");
    add("colour readback", target->color_readback.memory_bytes(), "colour is asked for");
    add("item readback", target->items_readback.memory_bytes(), "items are asked for");
  }
}

GpuImage RenderTargets::make_image(const Pass& pass, const char* what, VkFormat format, VkImageUsageFlags usage,
                                   bool samples) const {
  const std::uint32_t supersampling = samples ? pass.supersampling : 1;
  return GpuImage(device_, {.name = pass.name + what,
                            .width = pass.width_px * supersampling,
                            .height = pass.height_px * supersampling,
                            .format = format,
                            .usage = usage,
                            .samples = samples ? pass.msaa : 1,
                            .aspect = static_cast<VkImageAspectFlags>(
                                format == kDepthFormat ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT)});
}

// An image that the host reads in the end. Where it can be mapped it is not copied.
GpuImage RenderTargets::make_read(const Pass& pass, const char* what, VkFormat format, VkImageUsageFlags usage) const {
  GpuImageDesc desc{.name = pass.name + what,
                    .width = pass.width_px,
                    .height = pass.height_px,
                    .format = format,
                    .usage = usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
  desc.mapped = can_map_image(device_, desc);
  if (desc.mapped) {
    GpuImage image(device_, desc);
    if (image.pixels()) return image;
    desc.mapped = false;
  }
  return GpuImage(device_, std::move(desc));
}

std::unique_ptr<RenderTarget> RenderTargets::make(const Pass& pass) const {
  auto target = std::make_unique<RenderTarget>();
  target->width = pass.width_px;
  target->height = pass.height_px;
  target->supersampling = pass.supersampling;
  target->msaa = pass.msaa;
  target->shadow_maps = pass.shadow_maps;
  const bool averaged = pass.samples() > 1;
  const VkImageUsageFlags depth_read = averaged           ? 0
                                       : pass.shadow_maps ? VK_IMAGE_USAGE_SAMPLED_BIT
                                                          : VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  target->depth =
      make_image(pass, "/depth", kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | depth_read, true);
  if (averaged) {
    target->color_samples = make_image(pass, "/colour samples", kColorFormat,
                                       VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT, true);
    target->color = make_read(pass, "/colour", kColorFormat, VK_IMAGE_USAGE_STORAGE_BIT);
    target->average = average_.bind(target->color_samples, target->color);
  } else if (pass.color) {
    target->color = make_read(pass, "/colour", kColorFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
  } else if (pass.has_item_target()) {
    target->items = make_read(pass, "/items", kItemFormat, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
  }
  const VkImageView views[] = {target->depth.view(), averaged                 ? target->color_samples.view()
                                                     : pass.has_item_target() ? target->items.view()
                                                                              : target->color.view()};
  const VkFramebufferCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
      .pNext = nullptr,
      .flags = 0,
      .renderPass = pipelines_.render_pass(
          {.color = pass.color, .items = pass.has_item_target(), .sampled = pass.shadow_maps, .samples = pass.msaa}),
      .attachmentCount = pass.color || pass.has_item_target() ? 2u : 1u,
      .pAttachments = views,
      .width = pass.width_px * pass.supersampling,
      .height = pass.height_px * pass.supersampling,
      .layers = 1};
  VkFramebuffer framebuffer = VK_NULL_HANDLE;
  vk_check(vkCreateFramebuffer(device_.device, &info, nullptr, &framebuffer), "vkCreateFramebuffer");
  target->framebuffer = Handle<VkFramebuffer>(device_, framebuffer, pass.name + " framebuffer");
  return target;
}

}  // namespace simvis
