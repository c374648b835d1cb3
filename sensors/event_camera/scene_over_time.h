// The scene between two measurements of a camera: where its things stand in the view at any time in between.
//
// Frames   V = view frame of the camera: x right, y down, z forward.
// Time     a share of the time between the measurements: 0 at the earlier one, 1 at the later one. Items and the camera
//          move as screws with constant speed, see <simvis/pose.h>. Lights stand still.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/pose.h>

namespace simvis {

class SceneOverTime {
 public:
  /// `list` and `moves` are those of the later measurement and must live as long as the object is used. The poses are
  /// those of the view.
  void set(const DrawList& list, std::span<const ItemMove> moves, const glm::dmat4& world_from_view_before,
           const glm::dmat4& world_from_view_now);

  const DrawList& list() const { return *list_; }
  /// Whether the item moves in the view.
  bool moves(std::uint32_t item) const { return camera_moves_ || move_of_[item] != nullptr; }
  /// Whether anything moves in the view.
  bool any_moves() const { return camera_moves_ || any_move_; }

  glm::dmat4 world_from_view(double share) const;
  glm::dmat4 world_from_mesh(std::uint32_t item, double share) const;
  glm::dmat4 view_from_mesh(std::uint32_t item, double share) const;
  /// No point of the item's mesh that is at `place` accelerates by more in the view, in metres by the square of the
  /// time between the measurements.
  double acceleration_m(std::uint32_t item, const glm::dvec3& place) const;

 private:
  const DrawList* list_ = nullptr;
  std::vector<const ItemMove*> move_of_;  // by item; null: it stands still
  bool any_move_ = false, camera_moves_ = false;
  glm::dmat4 before_{1.0}, now_{1.0}, view_from_world_now_{1.0};
  double camera_way_m_ = 0, camera_turn_rad_ = 0;
};

}  // namespace simvis
