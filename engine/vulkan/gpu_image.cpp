#include "engine/vulkan/gpu_image.h"

#include "engine/base/assert.h"
#include "engine/vulkan/formats.h"
#include "engine/vulkan/vulkan_check.h"

namespace simvis {
namespace {

// The pixels of a mapped image. Null if there are gaps between rows.
const std::byte* pixels_of(const DeviceImpl& device, VkImage image, const GpuImageDesc& desc, std::byte* memory) {
  const VkImageSubresource whole{desc.aspect, 0, 0};
  VkSubresourceLayout layout{};
  vkGetImageSubresourceLayout(device.device, image, &whole, &layout);
  return layout.rowPitch == desc.width * texel_bytes(desc.format) ? memory + layout.offset : nullptr;
}

}  // namespace

bool can_map_image(const DeviceImpl& device, const GpuImageDesc& desc) {
  if (!device.physical.is_cpu()) return false;
  VkImageFormatProperties limits{};
  const VkResult result = vkGetPhysicalDeviceImageFormatProperties(
      device.physical.handle, desc.format, VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_LINEAR, desc.usage, 0, &limits);
  return result == VK_SUCCESS && desc.width <= limits.maxExtent.width && desc.height <= limits.maxExtent.height;
}

GpuImage::GpuImage(DeviceImpl& device, GpuImageDesc desc) : desc_(std::move(desc)) {
  SIMVIS_ASSERT(desc_.width > 0 && desc_.height > 0 && !desc_.name.empty());
  SIMVIS_ASSERT(!desc_.mapped || desc_.format == kColorFormat || desc_.format == kItemFormat);
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = desc_.format;
  info.extent = {desc_.width, desc_.height, 1};
  info.mipLevels = desc_.mip_levels;
  info.arrayLayers = 1;
  info.samples = static_cast<VkSampleCountFlagBits>(desc_.samples);
  info.tiling = desc_.mapped ? VK_IMAGE_TILING_LINEAR : VK_IMAGE_TILING_OPTIMAL;
  info.usage = desc_.usage;
  info.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
  VkImage image = VK_NULL_HANDLE;
  vk_check(vkCreateImage(device.device, &info, nullptr, &image), "vkCreateImage", desc_.name);
  image_ = Handle<VkImage>(device, image, desc_.name);
  memory_ = MemorySlice(device, image, desc_.mapped ? MemoryKind::readback : MemoryKind::image, desc_.name);
  if (desc_.mapped) pixels_ = pixels_of(device, image, desc_, memory_.mapped());

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
