// Which columns of a strip are read: made once for a view that many frames show.
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

  /// Whether they would be the same of this view.
  bool are_of(const View& view) const { return numbers_ == view.columns && before_.size() == view.width_px + 1ull; }
  /// Whether no view can name them any more.
  bool are_gone() const { return numbers_ != nullptr && numbers_.use_count() == 1; }

  /// How many of the first x columns are read, x <= the view's width.
  std::uint32_t before(std::size_t x) const { return before_[x]; }
  /// Of those that are read, where their centres lie, in pixels from the view's left.
  std::span<const float> centres_px() const { return centres_px_; }

 private:
  std::shared_ptr<const std::vector<std::uint32_t>> numbers_;
  std::vector<std::uint32_t> before_;
  std::vector<float> centres_px_;
};

/// Those of views that are still there.
class KnownStripColumns {
 public:
  /// Of the same address as long as the view's columns are there.
  const StripColumns& of(const View& view);

 private:
  std::list<StripColumns> known_;
};

}  // namespace simvis
