#include "sensors/camera/moved_world.h"

#include "engine/base/assert.h"

namespace simvis {

void MovedWorld::set(const DrawList& list) {
  list_ = &list;
  copied_ = false;
}

// The places follow the transforms of the list, in their order.
const DrawList& MovedWorld::place(std::span<const ItemPlace> places, unsigned threads) {
  SIMVIS_ASSERT(list_ != nullptr);
  if (caster_ == nullptr) caster_ = make_host_ray_caster({}, threads);
  if (places.empty()) {
    caster_->set_world(*list_);
    return *list_;
  }
  const std::size_t first = list_->world_from_node.size();
  if (!copied_) {
    moved_ = *list_;
    ++copies_;
    copied_ = true;
    moved_.world_from_node.resize(first + places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      moved_.items[places[i].item].transform = static_cast<std::uint32_t>(first + i);
    }
  }
  SIMVIS_ASSERT(moved_.world_from_node.size() == first + places.size());
  for (std::size_t i = 0; i < places.size(); ++i) moved_.world_from_node[first + i] = places[i].world_from_mesh;
  caster_->set_world(moved_);
  return moved_;
}

}  // namespace simvis
