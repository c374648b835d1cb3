// How the frames of a scene move between two measurements of a sensor.
//
// Time     a share of the time between the measurements: -1 at the earlier one, 0 at the later one.
// Motion   poses are known at both measurements and at the frames of the simulation between them. From one of these
//          times to the next, each joint of the chain that carries a frame moves on a screw of its own: it turns evenly
//          about one axis, by at most pi, and slides evenly. The chain's pose is their product (product of
//          exponentials; Murray, Li, Sastry, "A Mathematical Introduction to Robotic Manipulation", 1994, section 3.2).
//          What the same chain carries is therefore fixed to each other at all times.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include <simvis/export.h>

namespace simvis {

/// A screw motion with the axes of the world: a turn about an axis through a point, and the way of that point.
struct ScrewMotion {
  glm::dvec3 point_m{0},  ///< of the world
      turn_rad{0},        ///< axis times angle, at most pi
      way_m{0};           ///< the point's velocity at the end of the motion times its duration
};

/// A rigid displacement of the world about a point p: x becomes p + turn (x - p) + way_m.
struct Displacement {
  glm::dmat3 turn{1.0};  ///< a rotation
  glm::dvec3 way_m{0};   ///< of p
};

/// The motion from one time at which poses are known to the next.
struct MotionPiece {
  double begin = -1,                  ///< share of the time
      end = 0;                        ///< the same
  glm::dvec3 point_m{0};              ///< of `until_end`
  Displacement until_end{};           ///< leads from the pose at share 0 back to that at `end`
  std::vector<ScrewMotion> joints{};  ///< of the chain, the innermost one first, each from its pose at `begin`
};

/// The motion of a frame since a sensor's last measurement. Without pieces it stands still.
struct MotionPath {
  std::vector<MotionPiece> pieces{};  ///< ascending; the first begins at -1, each begins where the last ended
};

/// The motion of an item of a draw list.
struct ItemMove {
  std::uint32_t item = 0;                    ///< in DrawList::items
  std::shared_ptr<const MotionPath> path{};  ///< of the item's transform
};

/// Leads from the pose at share 0 to that at `share`, about a point of the world. Shares below -1 continue the first
/// piece backwards.
SIMVIS_API Displacement displacement(const MotionPath& path, double share, const glm::dvec3& point_m);

/// The pose at `share` of a frame that the path carries, from its pose at share 0.
SIMVIS_API glm::dmat4 place_at(const MotionPath& path, double share, const glm::dmat4& world_from_frame);

}  // namespace simvis
