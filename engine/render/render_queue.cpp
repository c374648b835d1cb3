#include "engine/render/render_queue.h"

#include <algorithm>
#include <numeric>

#include "engine/draw/canonical_order.h"

namespace simvis {

namespace {

/// Drawing order of two drawables, given by their indices.
struct Before {
  std::span<const Drawable> drawables;
  std::span<const glm::dmat4> world_from_node;

  bool operator()(std::uint32_t a, std::uint32_t b) const {
    const Drawable &x = drawables[a], &y = drawables[b];
    if (x.rank != y.rank) return x.rank < y.rank;
    const int places = compare_places(world_from_node[x.transform], world_from_node[y.transform]);
    return places != 0 ? places < 0 : x.item < y.item;
  }
};

}  // namespace

void RenderQueue::clear(std::size_t items) {
  drawables_.clear();
  order_.clear();
  position_.assign(items, kNone);
  solids_ = 0;
}

void RenderQueue::add(const Drawable& drawable) {
  position_[drawable.item] = static_cast<std::uint32_t>(order_.size());
  order_.push_back(static_cast<std::uint32_t>(drawables_.size()));
  drawables_.push_back(drawable);
  solids_ += drawable.key.topology == Topology::triangles;
}

void RenderQueue::sort(const DrawList& list) {
  const Before before{drawables_, list.world_from_node};
  if (std::ranges::is_sorted(order_, before)) return;
  std::ranges::sort(order_, before);
  for (std::uint32_t p = 0; p < order_.size(); ++p) position_[(*this)[p].item] = p;
}

void RenderQueue::sort(const DrawList& list, std::span<const std::uint32_t> moved_items) {
  const Before before{drawables_, list.world_from_node};
  std::vector<std::uint32_t> moved;
  bool sorted = true;
  for (const std::uint32_t item : moved_items) {
    const std::uint32_t p = position_[item];
    if (p == kNone) continue;
    moved.push_back(order_[p]);
    sorted = sorted && (p == 0 || before(order_[p - 1], order_[p]));
    sorted = sorted && (p + 1 == order_.size() || before(order_[p], order_[p + 1]));
  }
  if (sorted) return;
  std::ranges::sort(moved, before);
  moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
  for (auto first = moved.begin(); first != moved.end();) {
    const std::uint32_t rank = drawables_[*first].rank;
    const auto end = std::find_if(first, moved.end(), [&](std::uint32_t d) { return drawables_[d].rank != rank; });
    sort_among_rank({first, end}, before);
    first = end;
  }
}

// `moved` are drawables of one rank in sorted order. The other drawables of that rank are also in sorted order.
template <typename Less>
void RenderQueue::sort_among_rank(std::span<const std::uint32_t> moved, const Less& before) {
  const auto rank_of = [&](std::uint32_t drawable) { return drawables_[drawable].rank; };
  const auto first = std::ranges::lower_bound(order_, rank_of(moved.front()), {}, rank_of),
             last = std::ranges::upper_bound(order_, rank_of(moved.front()), {}, rank_of);
  for (const std::uint32_t drawable : moved) order_[position_[drawables_[drawable].item]] = kNone;
  auto rest = std::remove(first, last, kNone);
  auto end = last;
  for (std::size_t i = moved.size(); i-- > 0;) {
    const auto at = std::upper_bound(first, rest, moved[i], before);
    end = std::move_backward(at, rest, end);
    *--end = moved[i];
    rest = at;
  }
  for (auto p = first; p != last; ++p) {
    position_[drawables_[*p].item] = static_cast<std::uint32_t>(p - order_.begin());
  }
}

}  // namespace simvis
