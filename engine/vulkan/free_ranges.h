// Which ranges of a block of memory are free.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace simvis {

/// Bookkeeping only: it touches no memory. Best fit: the smallest free range that fits is taken, and the first one of
/// several of that size, so that the same calls always give the same places. Time is logarithmic in the number of free
/// ranges unless alignment rules many of them out.
class FreeRanges {
 public:
  /// One free range of `size` bytes, above 0.
  explicit FreeRanges(std::uint64_t size);

  /// Takes `size` bytes, above 0, at a multiple of `alignment`, a power of two. Returns where they begin; nothing when
  /// no free range holds them.
  std::optional<std::uint64_t> take(std::uint64_t size, std::uint64_t alignment);
  /// Gives back what take() returned; `size` as it was asked for. Joins free neighbours.
  void give_back(std::uint64_t first, std::uint64_t size);

  bool all_free() const { return free_bytes_ == size_; }
  std::uint64_t free_bytes() const { return free_bytes_; }
  std::size_t count() const { return by_place_.size(); }  ///< of free ranges, none of which touch

 private:
  void add(std::uint64_t first, std::uint64_t size);
  void remove(std::uint64_t first, std::uint64_t size);

  std::uint64_t size_, free_bytes_ = 0;
  std::map<std::uint64_t, std::uint64_t> by_place_;            // first byte to size
  std::set<std::pair<std::uint64_t, std::uint64_t>> by_size_;  // size, first byte
};

}  // namespace simvis
