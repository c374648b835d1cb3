#include "sensors/event_camera/scene_over_time.h"

#include <simvis/pose.h>
#include "engine/base/assert.h"

namespace simvis {

void SceneOverTime::set(const DrawList& list, std::span<const ItemMove> moves, const MotionPath& path,
                        const glm::dmat4& world_from_view_now) {
  SIMVIS_ASSERT(path.pieces.size() <= 1);
  list_ = &list;
  path_ = &path;
  now_ = world_from_view_now;
  view_from_world_now_ = rigid_inverse(now_);
  path_of_.assign(list.items.size(), nullptr);
  any_move_ = false;
  for (const ItemMove& move : moves) {
    path_of_[move.item] = move.path.get();
    any_move_ = any_move_ || list.items[move.item].visible;
  }
}

glm::dmat4 SceneOverTime::world_from_view(double share) const { return place_at(*path_, share - 1, now_); }

glm::dmat4 SceneOverTime::world_from_mesh(std::uint32_t item, double share) const {
  const glm::dmat4& now = list_->world_from_node[list_->items[item].transform];
  return path_of_[item] == nullptr ? now : place_at(*path_of_[item], share - 1, now);
}

glm::dmat4 SceneOverTime::view_from_mesh(std::uint32_t item, double share) const {
  const glm::dmat4 view_from_world = camera_moves() ? rigid_inverse(world_from_view(share)) : view_from_world_now_;
  return view_from_world * world_from_mesh(item, share);
}

// In the view a point goes on the screws of its chain, the innermost one first, then backwards on those of the camera's
// chain, the outermost one first. A screw (w, v) about p gives a point x that moves at most at the speed s the speed
// u = |v + w x (x - p)|, where x is at most s from its place now, and the acceleration |w| u + 2 |w| s.
double SceneOverTime::acceleration_m(std::uint32_t item, const glm::dvec3& place) const {
  const glm::dvec3 point_m(world_from_mesh(item, 1) * glm::dvec4(place, 1));
  double speed_m = 0, acceleration_m = 0;
  const auto follow = [&](const ScrewMotion& joint) {
    const double turn_rad = glm::length(joint.turn_rad);
    const double own_m =
        glm::length(joint.way_m + glm::cross(joint.turn_rad, point_m - joint.point_m)) + turn_rad * speed_m;
    acceleration_m += turn_rad * (own_m + 2 * speed_m);
    speed_m += own_m;
  };
  if (path_of_[item] != nullptr) {
    for (const ScrewMotion& joint : path_of_[item]->pieces.front().joints) follow(joint);
  }
  if (camera_moves()) {
    const std::vector<ScrewMotion>& joints = path_->pieces.front().joints;
    for (std::size_t i = joints.size(); i > 0; --i) follow(joints[i - 1]);
  }
  return acceleration_m;
}

}  // namespace simvis
