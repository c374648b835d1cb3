// A series of any length in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace simvis {

/// Keeps all values up to `max_kept`. Of a longer series it keeps every second, fourth, ... value from the first one
/// on.
template <class T, std::size_t max_kept>
class ThinnedSeries {
  static_assert(max_kept % 2 == 0, "the kept values would not stay evenly spaced");

 public:
  void add(T value) {
    if (count_++ % spacing_ != 0) return;
    if (kept_.size() == max_kept) {
      for (std::size_t i = 0; i < max_kept / 2; ++i) kept_[i] = std::move(kept_[2 * i]);
      kept_.resize(max_kept / 2);
      spacing_ *= 2;
    }
    kept_.push_back(std::move(value));
  }

  /// In the order in which they were added, evenly spaced.
  const std::vector<T>& kept() const { return kept_; }
  /// Of all values that were added.
  std::uint64_t count() const { return count_; }
  bool keeps_last() const { return count_ > 0 && (count_ - 1) % spacing_ == 0; }

 private:
  std::vector<T> kept_;
  std::uint64_t count_ = 0, spacing_ = 1;
};

}  // namespace simvis
