// A two-dimensional image with its memory and a view of the whole image.
#pragma once

#include <string>

#include "engine/vulkan/handle.h"
#include "engine/vulkan/memory_slice.h"

namespace simvis {

struct GpuImageDesc {
  std::string name;
  std::uint32_t width = 0, height = 0;  ///< pixels, above 0
  std::uint32_t mip_levels = 1;
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageUsageFlags usage = 0;
  std::uint32_t samples = 1;  ///< per pixel
  VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
};

class GpuImage {
 public:
  GpuImage() = default;
  GpuImage(DeviceImpl& device, GpuImageDesc desc);

  VkImage get() const { return image_.get(); }
  VkImageView view() const { return view_.get(); }
  const GpuImageDesc& desc() const { return desc_; }
  std::uint64_t memory_bytes() const { return memory_.bytes(); }  ///< with the device's rounding
  explicit operator bool() const { return static_cast<bool>(image_); }

 private:
  GpuImageDesc desc_;
  MemorySlice memory_;     // outlives the image
  Handle<VkImage> image_;  // outlives the view
  Handle<VkImageView> view_;
};

}  // namespace simvis
