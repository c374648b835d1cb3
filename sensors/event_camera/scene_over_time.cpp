#include "sensors/event_camera/scene_over_time.h"

#include "scenegraph/motion.h"

namespace simvis {

void SceneOverTime::set(const DrawList& list, std::span<const ItemMove> moves, const glm::dmat4& world_from_view_before,
                        const glm::dmat4& world_from_view_now) {
  list_ = &list;
  before_ = world_from_view_before;
  now_ = world_from_view_now;
  view_from_world_now_ = rigid_inverse(now_);
  camera_moves_ = before_ != now_;
  const ItemMove move_of_camera = camera_moves_ ? move_between(before_, now_) : ItemMove{};
  camera_way_m_ = glm::length(move_of_camera.way_m);
  camera_turn_rad_ = glm::length(move_of_camera.turn_rad);
  move_of_.assign(list.items.size(), nullptr);
  any_move_ = false;
  for (const ItemMove& move : moves) {
    if (move.turn_rad == glm::dvec3(0) && move.way_m == glm::dvec3(0)) continue;
    move_of_[move.item] = &move;
    any_move_ = any_move_ || list.items[move.item].visible;
  }
}

glm::dmat4 SceneOverTime::world_from_view(double share) const {
  return camera_moves_ && share < 1 ? pose_between(before_, now_, share) : now_;
}

glm::dmat4 SceneOverTime::world_from_mesh(std::uint32_t item, double share) const {
  const glm::dmat4& now = list_->world_from_node[list_->items[item].transform];
  const ItemMove* const move = move_of_[item];
  return move == nullptr || share == 1 ? now : place_at(*move, share - 1, now);
}

glm::dmat4 SceneOverTime::view_from_mesh(std::uint32_t item, double share) const {
  const glm::dmat4 view_from_world = camera_moves_ ? rigid_inverse(world_from_view(share)) : view_from_world_now_;
  return view_from_world * world_from_mesh(item, share);
}

// On its screw a point has one speed, and the acceleration turn x speed. In a view that turns are added 2 turn x
// relative speed and turn^2 x distance.
double SceneOverTime::acceleration_m(std::uint32_t item, const glm::dvec3& place) const {
  const glm::dvec3 point_m(world_from_mesh(item, 1) * glm::dvec4(place, 1));
  const ItemMove* const move = move_of_[item];
  double speed_m = 0, turn_rad = 0;
  if (move != nullptr) {
    speed_m = glm::length(move->way_m + glm::cross(move->turn_rad, point_m - move->point_m));
    turn_rad = glm::length(move->turn_rad);
  }
  const double relative_m = speed_m + camera_way_m_;
  const double farthest_m = glm::length(point_m - glm::dvec3(now_[3])) + relative_m;
  return turn_rad * speed_m + camera_turn_rad_ * (2 * relative_m + camera_turn_rad_ * farthest_m);
}

}  // namespace simvis
