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
  bool mapped = false;  ///< the host reads the pixels where they are; needs can_map_image()
};

/// Whether the host can read such an image of one level where the device writes it, without loss of speed: the device
/// is the CPU itself.
bool can_map_image(const DeviceImpl& device, const GpuImageDesc& desc);

class GpuImage {
 public:
  GpuImage() = default;
  GpuImage(DeviceImpl& device, GpuImageDesc desc);

  VkImage get() const { return image_.get(); }
  VkImageView view() const { return view_.get(); }
  const GpuImageDesc& desc() const { return desc_; }
  std::uint64_t memory_bytes() const { return memory_.bytes(); }  ///< with the device's rounding
  /// The pixels, row after row without gaps; null if the image is not mapped, or if the device leaves gaps.
  const std::byte* pixels() const { return pixels_; }
  explicit operator bool() const { return static_cast<bool>(image_); }

 private:
  GpuImageDesc desc_;
  MemorySlice memory_;     // outlives the image
  Handle<VkImage> image_;  // outlives the view
  Handle<VkImageView> view_;
  const std::byte* pixels_ = nullptr;
};

}  // namespace simvis
