// A buffer with its own memory, mapped for as long as it lives where the host may see it.
#pragma once

#include <cstddef>
#include <string>

#include "engine/vulkan/handle.h"
#include "engine/vulkan/memory_ledger.h"

namespace simvis {

struct BufferDesc {
  std::string name;
  VkDeviceSize size = 0;  ///< bytes, above 0
  VkBufferUsageFlags usage = 0;
  MemoryKind memory = MemoryKind::device;
};

class Buffer {
 public:
  Buffer() = default;
  Buffer(Device::Impl& device, BufferDesc desc);

  VkBuffer get() const { return buffer_.get(); }
  VkDeviceSize size() const { return desc_.size; }
  const BufferDesc& desc() const { return desc_; }
  std::uint64_t memory_bytes() const { return held_.bytes(); }  ///< that it takes, the device's rounding included
  std::byte* mapped() const { return mapped_; }                 ///< null where the host does not see it
  explicit operator bool() const { return static_cast<bool>(buffer_); }

 private:
  BufferDesc desc_;
  MemoryLedger held_;
  Handle<VkDeviceMemory> memory_;  // outlives the buffer
  Handle<VkBuffer> buffer_;
  std::byte* mapped_ = nullptr;
};

}  // namespace simvis
