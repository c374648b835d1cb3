// A list that grows for as long as a run lasts, in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace simvis {

/// Keeps each value up to kMaxKept. Of more it keeps every second, fourth, ... from the first one on, and the last one.
template <typename T>
class ThinnedList {
 public:
  static constexpr std::size_t kMaxKept = 16'384;  ///< even, so that what is kept stays evenly spaced

  void add(T value) {
    last_ = std::move(value);
    if (added_++ % spacing_ != 0) return;
    if (kept_.size() == kMaxKept) {
      for (std::size_t i = 0; i < kMaxKept / 2; ++i) kept_[i] = std::move(kept_[2 * i]);
      kept_.resize(kMaxKept / 2);
      spacing_ *= 2;
    }
    kept_.push_back(last_);
  }
  /// In their order, at most kMaxKept + 1; evenly spaced, except for the last one.
  std::vector<T> values() const {
    std::vector<T> values = kept_;
    if (added_ > 0 && (added_ - 1) % spacing_ != 0) values.push_back(last_);
    return values;
  }
  std::uint64_t added() const { return added_; }  ///< how many have come
  const T& last() const { return last_; }         ///< of added() > 0

 private:
  std::vector<T> kept_;
  T last_{};
  std::uint64_t added_ = 0, spacing_ = 1;
};

}  // namespace simvis
