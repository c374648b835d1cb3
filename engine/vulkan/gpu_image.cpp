#include "engine/vulkan/gpu_image.h"

#include "engine/base/assert.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {

GpuImage::GpuImage(DeviceImpl& device, GpuImageDesc desc) : desc_(std::move(desc)) {
  SIMVIS_ASSERT(desc_.width > 0 && desc_.height > 0 && !desc_.name.empty());
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = desc_.format;
  info.extent = {desc_.width, desc_.height, 1};
  info.mipLevels = desc_.mip_levels;
  info.arrayLayers = 1;
  info.samples = static_cast<VkSampleCountFlagBits>(desc_.samples);
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = desc_.usage;
  info.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
  VkImage image = VK_NULL_HANDLE;
  vk_check(vkCreateImage(device.device, &info, nullptr, &image), "vkCreateImage", desc_.name);
  image_ = Handle<VkImage>(device, image, desc_.name);
  memory_ = MemorySlice(device, image, desc_.name);

  VkImageViewCreateInfo view_info{};
  view_info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  view_info.image = image;
  view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view_info.format = desc_.format;
  view_info.subresourceRange = {desc_.aspect, 0, desc_.mip_levels, 0, 1};
  VkImageView view = VK_NULL_HANDLE;
  vk_check(vkCreateImageView(device.device, &view_info, nullptr, &view), "vkCreateImageView");
  view_ = Handle<VkImageView>(device, view, desc_.name + " view");
}

}  // namespace simvis
