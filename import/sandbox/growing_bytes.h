// Bytes whose number is not known before they have come.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>

namespace simvis {

/// Unlike a vector, it neither clears nor copies the memory that it grows into: the system moves large blocks by their
/// pages, so that only bytes that have come take memory.
class GrowingBytes {
 public:
  /// Room for at least one byte behind the end, up to `most` bytes in all. Throws std::bad_alloc.
  std::span<std::uint8_t> room(std::size_t most) {
    constexpr std::size_t kFirstBytes = std::size_t{1} << 16;
    if (size_ == capacity_ && capacity_ < most) {
      const std::size_t grown = std::min(std::max(kFirstBytes, 2 * capacity_), most);
      void* const moved = std::realloc(bytes_.get(), grown);
      if (moved == nullptr) throw std::bad_alloc();
      static_cast<void>(bytes_.release());
      bytes_.reset(static_cast<std::uint8_t*>(moved));
      capacity_ = grown;
    }
    return {bytes_.get() + size_, capacity_ - size_};
  }
  void add(std::size_t count) { size_ += count; }  ///< that have been written to room()

  std::span<const std::uint8_t> bytes() const { return {bytes_.get(), size_}; }

 private:
  struct Free {
    void operator()(std::uint8_t* bytes) const { std::free(bytes); }
  };
  std::unique_ptr<std::uint8_t, Free> bytes_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace simvis
