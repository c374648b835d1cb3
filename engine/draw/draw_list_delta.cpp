#include <simvis/draw_list_delta.h>

#include <algorithm>
#include <atomic>

#include "engine/base/assert.h"

namespace simvis {

namespace {

// Reading more entries costs at least as much as comparing everything.
constexpr std::size_t kMaxRemembered = 1 << 16;

template <typename T>
void remember(std::vector<T>& log, const T& change) {
  if (log.size() == kMaxRemembered) log.erase(log.begin(), log.begin() + kMaxRemembered / 2);
  log.push_back(change);
}

/// The latest `missed` changes, if the log still has them.
template <typename T>
std::optional<std::span<const T>> latest(const std::vector<T>& log, std::uint64_t missed) {
  if (missed > log.size()) return {};
  return std::span(log).last(static_cast<std::size_t>(missed));
}

}  // namespace

DrawListDelta& DrawListDelta::operator=(const DrawListDelta& other) {
  if (this == &other) return *this;
  now_ = {};
  moves_.clear();
  items_.clear();
  index_.reset();
  return *this;
}

void DrawListDelta::mark_structure_dirty() {
  static std::atomic<std::uint64_t> last = 0;
  now_ = {.structure = ++last};
  moves_.clear();
  items_.clear();
}

void DrawListDelta::mark_item_dirty(std::uint32_t item) {
  SIMVIS_ASSERT(kept());
  remember(items_, item);
  ++now_.items;
}

void DrawListDelta::mark_transforms_dirty(TransformRange entries) {
  SIMVIS_ASSERT(kept() && entries.first <= entries.end);
  remember(moves_, entries);
  ++now_.moves;
}

std::optional<std::span<const TransformRange>> DrawListDelta::moved_since(const ListVersion& seen) const {
  if (!same_structure(seen)) return {};
  return latest(moves_, now_.moves - seen.moves);
}

std::optional<std::span<const std::uint32_t>> DrawListDelta::items_since(const ListVersion& seen) const {
  if (!same_structure(seen)) return {};
  return latest(items_, now_.items - seen.items);
}

StandingAt::StandingAt(std::span<const std::uint32_t> transform_of, std::size_t transforms)
    : first_(transforms + 1), objects_(transform_of.size()) {
  for (const std::uint32_t transform : transform_of) ++first_[transform + 1];
  for (std::size_t t = 0; t < transforms; ++t) first_[t + 1] += first_[t];
  std::vector<std::uint32_t> next = first_;
  for (std::uint32_t object = 0; object < transform_of.size(); ++object)
    objects_[next[transform_of[object]]++] = object;
}

std::span<const std::uint32_t> StandingAt::operator[](TransformRange entries) const {
  const std::size_t last = first_.size() - 1;
  const std::uint32_t first = first_[std::min<std::size_t>(entries.first, last)];
  return std::span(objects_).subspan(first, first_[std::min<std::size_t>(entries.end, last)] - first);
}

}  // namespace simvis
