#include "engine/base/free_ranges.h"

#include <bit>
#include <iterator>

#include "engine/base/assert.h"

namespace simvis {

FreeRanges::FreeRanges(std::uint64_t size) : size_(size) {
  SIMVIS_ASSERT(size > 0);
  add(0, size);
}

std::optional<std::uint64_t> FreeRanges::take(std::uint64_t size, std::uint64_t alignment) {
  SIMVIS_ASSERT(size > 0 && std::has_single_bit(alignment));
  for (auto range = by_size_.lower_bound({size, 0}); range != by_size_.end(); ++range) {
    const auto [held, first] = *range;
    const std::uint64_t padding = (alignment - first % alignment) % alignment;
    if (held < size || held - size < padding) continue;
    remove(first, held);
    if (padding > 0) add(first, padding);
    if (held > padding + size) add(first + padding + size, held - padding - size);
    return first + padding;
  }
  return std::nullopt;
}

void FreeRanges::give_back(std::uint64_t first, std::uint64_t size) {
  SIMVIS_ASSERT(size > 0 && first <= size_ && size <= size_ - first);
  const auto next = by_place_.lower_bound(first);
  SIMVIS_ASSERT(next == by_place_.end() || first + size <= next->first);
  std::uint64_t joined_first = first, joined_size = size;
  if (next != by_place_.begin()) {
    const auto [previous_first, previous_size] = *std::prev(next);
    SIMVIS_ASSERT(previous_first + previous_size <= first);
    if (previous_first + previous_size == first) {
      joined_first = previous_first;
      joined_size += previous_size;
    }
  }
  std::uint64_t next_size = 0;
  if (next != by_place_.end() && next->first == first + size) next_size = next->second;
  if (joined_first < first) remove(joined_first, first - joined_first);
  if (next_size > 0) remove(first + size, next_size);
  add(joined_first, joined_size + next_size);
}

void FreeRanges::add(std::uint64_t first, std::uint64_t size) {
  by_place_.emplace(first, size);
  by_size_.emplace(size, first);
  free_bytes_ += size;
}

void FreeRanges::remove(std::uint64_t first, std::uint64_t size) {
  by_place_.erase(first);
  by_size_.erase({size, first});
  free_bytes_ -= size;
}

}  // namespace simvis
