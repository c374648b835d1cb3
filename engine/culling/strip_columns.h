// The columns of a strip view that are read, computed once for a view that appears in many frames.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <span>
#include <vector>

#include <simvis/frame_plan.h>

namespace simvis {

class StripColumns {
 public:
  explicit StripColumns(const View& view);

  /// Returns whether this view has the same columns.
  bool are_of(const View& view) const { return numbers_ == view.columns && before_.size() == view.width_px + 1ull; }
  /// Returns whether no view refers to the list of columns any more.
  bool are_gone() const { return numbers_ != nullptr && numbers_.use_count() == 1; }

  /// The number of read columns among the first x columns, x <= the view's width.
  std::uint32_t before(std::size_t x) const { return before_[x]; }
  /// The centres of the read columns, in pixels from the view's left side.
  std::span<const float> centres_px() const { return centres_px_; }

 private:
  std::shared_ptr<const std::vector<std::uint32_t>> numbers_;
  std::vector<std::uint32_t> before_;
  std::vector<float> centres_px_;
};

/// Cache of the columns of views that still exist.
class KnownStripColumns {
 public:
  /// The address of the result does not change while the view's list of columns exists.
  const StripColumns& of(const View& view);

 private:
  std::list<StripColumns> known_;
};

}  // namespace simvis
