#include "sensors/camera/camera_moment.h"

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"
#include "scenegraph/motion_path.h"

namespace simvis {

std::shared_ptr<const KeptScene> SceneKeeper::keep(const SensedScene& scene, std::span<const ItemMove> moves) {
  auto free = std::ranges::find_if(kept_, [](const std::shared_ptr<Kept>& each) { return each.use_count() == 1; });
  if (free == kept_.end()) free = kept_.insert(free, std::make_shared<Kept>(layer_));
  Kept& kept = **free;
  kept.list.follow(scene.list);
  kept.scene.shape.assign(scene.shape.begin(), scene.shape.end());
  kept.scene.moves.assign(moves.begin(), moves.end());
  return {*free, &kept.scene};
}

std::uint64_t SceneKeeper::lists_copied() const {
  std::uint64_t copies = 0;
  for (const std::shared_ptr<Kept>& each : kept_) copies += each->list.copies();
  return copies;
}

glm::dmat4 CameraMoment::world_from_mesh(std::size_t of_rows, std::uint32_t item) const {
  const DrawList& list = scene->list;
  const glm::dmat4& world_from_mesh = list.world_from_node[list.items[item].transform];
  const auto move = std::ranges::lower_bound(scene->moves, item, {}, &ItemMove::item);
  if (rows[of_rows].share == 0 || move == scene->moves.end() || move->item != item) return world_from_mesh;
  return place_at(*move->path, rows[of_rows].share, world_from_mesh);
}

std::vector<ItemPlace> CameraMoment::places(std::size_t of_rows) const {
  std::vector<ItemPlace> places;
  if (rows[of_rows].share == 0) return places;
  for (const ItemMove& move : scene->moves) places.push_back({move.item, world_from_mesh(of_rows, move.item)});
  return places;
}

std::size_t CameraMoment::rows_at(double y_px) const {
  SIMVIS_ASSERT(!rows.empty());
  const auto behind = std::ranges::upper_bound(rows, y_px, {}, [](const PosedRows& each) { return each.first; });
  return behind == rows.begin() ? 0 : static_cast<std::size_t>(behind - rows.begin()) - 1;
}

void MomentHistory::add(CameraMoment moment) {
  if (now_ && now_->time_ns < moment.time_ns) before_ = std::move(now_);
  now_ = std::move(moment);
}

}  // namespace simvis
