// Bytes that are part of a total for the lifetime of their owner.
#pragma once

#include <cstdint>
#include <utility>

namespace simvis {

class MemoryLedger {
 public:
  MemoryLedger() = default;
  /// Adds `bytes` to `total`, which must outlive this object.
  MemoryLedger(std::uint64_t& total, std::uint64_t bytes) : total_(&total), bytes_(bytes) { total += bytes; }
  ~MemoryLedger() { release(); }
  MemoryLedger(MemoryLedger&& other) noexcept : total_(other.total_), bytes_(std::exchange(other.bytes_, 0)) {}
  MemoryLedger& operator=(MemoryLedger&& other) noexcept {
    if (this != &other) {
      release();
      total_ = other.total_;
      bytes_ = std::exchange(other.bytes_, 0);
    }
    return *this;
  }

  std::uint64_t bytes() const { return bytes_; }

 private:
  void release() {
    if (bytes_ > 0) *total_ -= std::exchange(bytes_, 0);
  }

  std::uint64_t* total_ = nullptr;
  std::uint64_t bytes_ = 0;
};

}  // namespace simvis
