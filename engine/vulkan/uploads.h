// Brings data of the host to the device, within the frame's command buffer.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/vulkan/buffer.h"
#include "engine/vulkan/gpu_image.h"

namespace simvis {

/// One way for buffers, chosen by the device: straight into mapped memory, or by staging buffers and copies. Textures
/// always go through staging buffers.
class Uploads {
 public:
  explicit Uploads(Device::Impl& device) : device_(device) {}

  void begin(VkCommandBuffer commands);

  void write(const Buffer& target, VkDeviceSize offset, std::span<const std::byte> data);

  /// Fills the first level with `rgba` (rows from the top) and makes the others from it; the image is then ready for
  /// sampling.
  void write(const GpuImage& target, std::span<const std::byte> rgba);

  /// Copies within the device; counts no byte as uploaded.
  void copy(const Buffer& from, const Buffer& to, VkDeviceSize from_offset, VkDeviceSize to_offset, VkDeviceSize size);

  /// Makes all of it visible to what is recorded afterwards.
  void finish();

  /// Lets the staging memory go, once the submission has finished.
  void release() { staging_.clear(); }

  std::uint64_t bytes() const { return bytes_; }  ///< since begin()
  /// Of them, those that went to one buffer or image.
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
  void make_mips(const GpuImage& image);

  Device::Impl& device_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  std::vector<Buffer> staging_;
  VkDeviceSize used_ = 0;  // of the last staging buffer
  std::uint64_t bytes_ = 0;
  std::vector<Written> written_;
  bool copies_ = false;
};

}  // namespace simvis
