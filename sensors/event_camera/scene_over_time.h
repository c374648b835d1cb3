// The scene between two measurements of a camera: where its objects stand in the view at any time in between.
//
// Frames   V = view frame of the camera: x right, y down, z forward.
// Time     a share of the time between the measurements: 0 at the earlier one, 1 at the later one. Items and the camera
//          move on paths in one piece, see <simvis/motion_path.h>. Lights stand still.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include <simvis/draw_list.h>
#include <simvis/motion_path.h>

namespace simvis {

class SceneOverTime {
 public:
  /// `list`, `moves` and the view's `path` are those of the later measurement and must live as long as the object is
  /// used.
  void set(const DrawList& list, std::span<const ItemMove> moves, const MotionPath& path,
           const glm::dmat4& world_from_view_now);

  const DrawList& list() const { return *list_; }
  /// Whether the item moves in the view.
  bool moves(std::uint32_t item) const { return camera_moves() || path_of_[item] != nullptr; }
  /// Whether anything moves in the view.
  bool any_moves() const { return camera_moves() || any_move_; }

  glm::dmat4 world_from_view(double share) const;
  glm::dmat4 world_from_mesh(std::uint32_t item, double share) const;
  glm::dmat4 view_from_mesh(std::uint32_t item, double share) const;
  /// No point of the item's mesh that is at `place` accelerates by more in the view, in metres by the square of the
  /// time between the measurements.
  double acceleration_m(std::uint32_t item, const glm::dvec3& place) const;

 private:
  bool camera_moves() const { return !path_->pieces.empty(); }

  const DrawList* list_ = nullptr;
  const MotionPath* path_ = nullptr;        // of the view
  std::vector<const MotionPath*> path_of_;  // by item; null: it stands still
  bool any_move_ = false;
  glm::dmat4 now_{1.0}, view_from_world_now_{1.0};
};

}  // namespace simvis
