// A buffer and its memory. Memory that the host accesses stays mapped for the lifetime of the buffer.
#pragma once

#include <cstddef>
#include <string>

#include "engine/vulkan/handle.h"
#include "engine/vulkan/memory_slice.h"

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
  Buffer(DeviceImpl& device, BufferDesc desc);

  VkBuffer get() const { return buffer_.get(); }
  VkDeviceSize size() const { return desc_.size; }
  const BufferDesc& desc() const { return desc_; }
  std::uint64_t memory_bytes() const { return memory_.bytes(); }  ///< with the device's rounding
  std::byte* mapped() const { return memory_.mapped(); }          ///< null if the memory is not mapped
  explicit operator bool() const { return static_cast<bool>(buffer_); }

 private:
  BufferDesc desc_;
  MemorySlice memory_;  // outlives the buffer
  Handle<VkBuffer> buffer_;
};

}  // namespace simvis
