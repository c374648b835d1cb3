// The memory of one buffer or image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

#include "engine/vulkan/device_impl.h"
#include "engine/vulkan/memory_ledger.h"

namespace simvis {

/// A move-only owner of a memory range, which must outlive the handle of the resource. After its destruction, other
/// resources can use the range as soon as the submission that may still use it has finished.
class MemorySlice {
 public:
  MemorySlice() = default;
  /// Both bind the resource to its memory and throw MachineError if no memory is left. `name` is for messages.
  MemorySlice(DeviceImpl& device, VkBuffer buffer, MemoryKind kind, std::string_view name);
  /// `kind`: image or readback.
  MemorySlice(DeviceImpl& device, VkImage image, MemoryKind kind, std::string_view name);
  ~MemorySlice() { retire(); }
  MemorySlice(MemorySlice&& other) noexcept
      : device_(other.device_), range_(std::move(other.range_)), held_(std::move(other.held_)) {}
  MemorySlice& operator=(MemorySlice&& other) noexcept {
    if (this != &other) {
      retire();
      device_ = other.device_;
      range_ = std::move(other.range_);
      held_ = std::move(other.held_);
    }
    return *this;
  }

  std::uint64_t bytes() const { return held_.bytes(); }  ///< size that the device requires
  /// Null if the memory is not mapped.
  std::byte* mapped() const { return range_ == nullptr ? nullptr : range_->mapped; }

 private:
  void take(const MemoryRequest& request);
  void retire();

  DeviceImpl* device_ = nullptr;
  std::unique_ptr<MemoryRange> range_;  // by its address the retire list holds it without an allocation
  MemoryLedger held_;
};

}  // namespace simvis
