// Keeps track of the free ranges of a block of memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace simvis {

/// The class does not access the memory itself. Best fit: it takes the smallest free range that fits, and the first one
/// of several with that size, so that the same calls always give the same positions. Time is logarithmic in the number
/// of free ranges unless alignment rules many of them out. take() allocates all that give_back() may need, which never
/// throws; if take() throws std::bad_alloc, nothing has changed. The first take() does not throw.
class FreeRanges {
 public:
  /// Starts with one free range of `size` bytes, above 0.
  explicit FreeRanges(std::uint64_t size);

  /// Takes `size` bytes, above 0, at a multiple of `alignment`, a power of two. Returns the first byte; nothing if no
  /// free range is large enough.
  std::optional<std::uint64_t> take(std::uint64_t size, std::uint64_t alignment);
  /// Gives back a range that take() returned, with the `size` of that call. Joins adjacent free ranges.
  void give_back(std::uint64_t first, std::uint64_t size);

  bool all_free() const { return free_bytes_ == size_; }
  std::uint64_t free_bytes() const { return free_bytes_; }
  std::size_t count() const { return by_place_.size(); }  ///< number of free ranges; no two of them are adjacent

 private:
  using ByPlace = std::map<std::uint64_t, std::uint64_t>;            // first byte to size
  using BySize = std::set<std::pair<std::uint64_t, std::uint64_t>>;  // size, first byte
  void reserve_nodes(std::size_t count);
  void add(std::uint64_t first, std::uint64_t size);
  void remove(std::uint64_t first, std::uint64_t size);

  std::uint64_t size_, free_bytes_ = 0;
  std::size_t taken_ = 0;  // ranges
  ByPlace by_place_;
  BySize by_size_;
  // For ranges that become free: one for each that is taken, at least.
  std::vector<ByPlace::node_type> place_nodes_;
  std::vector<BySize::node_type> size_nodes_;
};

}  // namespace simvis
