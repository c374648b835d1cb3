#include "engine/base/free_ranges.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <utility>

#include "engine/base/assert.h"

namespace simvis {

FreeRanges::FreeRanges(std::uint64_t size) : size_(size) {
  SIMVIS_ASSERT(size > 0);
  constexpr std::size_t kOfFirstTake = 2;
  reserve_nodes(1 + kOfFirstTake);
  add(0, size);
}

std::optional<std::uint64_t> FreeRanges::take(std::uint64_t size, std::uint64_t alignment) {
  SIMVIS_ASSERT(size > 0 && std::has_single_bit(alignment));
  for (auto range = by_size_.lower_bound({size, 0}); range != by_size_.end(); ++range) {
    const auto [held, first] = *range;
    const std::uint64_t padding = (alignment - first % alignment) % alignment;
    if (held < size || held - size < padding) continue;
    reserve_nodes(taken_ + 2);  // one more free range now, and one for each range that is given back
    ++taken_;
    remove(first, held);
    if (padding > 0) add(first, padding);
    if (held > padding + size) add(first + padding + size, held - padding - size);
    return first + padding;
  }
  return std::nullopt;
}

void FreeRanges::give_back(std::uint64_t first, std::uint64_t size) {
  SIMVIS_ASSERT(taken_ > 0 && size > 0 && first <= size_ && size <= size_ - first);
  --taken_;
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

// So many nodes, and room for all nodes that exist, so that remove() allocates nothing.
void FreeRanges::reserve_nodes(std::size_t count) {
  const std::size_t all = by_place_.size() + std::max(count, place_nodes_.size());
  if (place_nodes_.capacity() < all) place_nodes_.reserve(2 * all);
  if (size_nodes_.capacity() < all) size_nodes_.reserve(2 * all);
  while (place_nodes_.size() < count) {
    ByPlace made{{0, 0}};
    place_nodes_.push_back(made.extract(made.begin()));
  }
  while (size_nodes_.size() < count) {
    BySize made{{0, 0}};
    size_nodes_.push_back(made.extract(made.begin()));
  }
}

void FreeRanges::add(std::uint64_t first, std::uint64_t size) {
  SIMVIS_ASSERT(!place_nodes_.empty() && !size_nodes_.empty());
  place_nodes_.back().key() = first;
  place_nodes_.back().mapped() = size;
  by_place_.insert(std::move(place_nodes_.back()));
  place_nodes_.pop_back();
  size_nodes_.back().value() = {size, first};
  by_size_.insert(std::move(size_nodes_.back()));
  size_nodes_.pop_back();
  free_bytes_ += size;
}

void FreeRanges::remove(std::uint64_t first, std::uint64_t size) {
  place_nodes_.push_back(by_place_.extract(first));
  size_nodes_.push_back(by_size_.extract({size, first}));
  free_bytes_ -= size;
}

}  // namespace simvis
