// Uploads host data to the device within the frame's command buffer.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/vulkan/buffer.h"
#include "engine/vulkan/gpu_image.h"

namespace simvis {

/// Data for a mapped buffer is written directly into its memory; data for other buffers is copied from staging buffers.
/// Textures always use staging buffers.
class Uploads {
 public:
  explicit Uploads(DeviceImpl& device) : device_(device) {}

  void begin(VkCommandBuffer commands);

  void write(const Buffer& target, VkDeviceSize offset, std::span<const std::byte> data);

  /// Fills all mip levels with texels of its format, rows from the top. The image is then ready for sampling.
  void write(const GpuImage& target, std::span<const std::span<const std::byte>> levels);

  /// Copies within the device. These bytes do not count as uploaded.
  void copy(const Buffer& from, const Buffer& to, VkDeviceSize from_offset, VkDeviceSize to_offset, VkDeviceSize size);

  /// Makes all uploads visible to the commands recorded afterwards.
  void finish();

  /// Frees the staging memory. The submission must have finished.
  void release() { staging_.clear(); }

  std::uint64_t bytes() const { return bytes_; }  ///< uploaded since begin()
  /// The part of bytes() that went to one buffer or image.
  std::uint64_t bytes_to(const Buffer& target) const { return bytes_to(reinterpret_cast<std::uint64_t>(target.get())); }
  std::uint64_t bytes_to(const GpuImage& target) const {
    return bytes_to(reinterpret_cast<std::uint64_t>(target.get()));
  }

 private:
  struct Written {
    std::uint64_t target, bytes;
  };
  struct Staged {
    VkBuffer buffer;
    VkDeviceSize offset;
  };
  void count(std::uint64_t target, std::uint64_t bytes);
  std::uint64_t bytes_to(std::uint64_t target) const;
  Staged stage(std::span<const std::byte> data);
  void note_copy_to(const Buffer& target);

  DeviceImpl& device_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  std::vector<Buffer> staging_;
  VkDeviceSize used_ = 0;  // bytes used of the last staging buffer
  std::uint64_t bytes_ = 0;
  std::vector<Written> written_;
  bool copies_ = false;
  std::vector<VkBuffer> copied_to_;  // since the last barrier between copies
};

}  // namespace simvis
