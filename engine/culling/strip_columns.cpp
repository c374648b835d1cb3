#include "engine/culling/strip_columns.h"

#include <algorithm>
#include <numeric>

#include "engine/base/assert.h"

namespace simvis {

StripColumns::StripColumns(const View& view) : numbers_(view.columns), before_(view.width_px + std::size_t{1}) {
  for (std::uint32_t x = 0; x < view.width_px; ++x) before_[x + 1] = numbers_ ? 0 : 1;
  if (numbers_) {
    for (const std::uint32_t x : *numbers_) {
      SIMVIS_ASSERT(x < view.width_px);
      before_[x + 1] = 1;
    }
  }
  for (std::uint32_t x = 0; x < view.width_px; ++x) {
    if (before_[x + 1] != 0) centres_px_.push_back(static_cast<float>(x) + 0.5f);
  }
  std::partial_sum(before_.begin(), before_.end(), before_.begin());
}

const StripColumns& KnownStripColumns::of(const View& view) {
  const auto found = std::ranges::find_if(known_, [&](const StripColumns& each) { return each.are_of(view); });
  if (found != known_.end()) return *found;
  known_.remove_if([](const StripColumns& each) { return each.are_gone(); });
  return known_.emplace_back(view);
}

}  // namespace simvis
