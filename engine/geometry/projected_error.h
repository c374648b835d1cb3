// How large an error of a mesh's surface appears in a view: what decides which level of a mesh is drawn.
#pragma once

#include <glm/glm.hpp>

#include <simvis/frame_plan.h>
#include "engine/geometry/view_projection.h"

namespace simvis {

/// The errors of one mesh in one view.
class ProjectedError {
 public:
  /// `box` is that of the mesh with the transform `world_from_mesh`, which may scale its axes.
  ProjectedError(const View& view, const ViewProjection& projection, const WorldBox& box,
                 const glm::dmat4& world_from_mesh);

  /// An upper bound, in pixels of the view, on the distance at which the view shows two points that are `error_m` apart
  /// in the mesh's frame, one of them within the box and the view. Infinite if the other may reach the near plane.
  double px(double error_m) const;
  /// An upper bound on the length in the world of a vector of the length `error_m` in the mesh's frame.
  double world_m(double error_m) const { return stretch_ * error_m; }

 private:
  bool orthographic_;
  double near_m_;
  double focal_px_;       // orthographic: per metre; else at a depth of 1 m, times the slant at the edge of the view
  double stretch_ = 0;    // the largest factor by which the transform lengthens a vector, or more
  double nearest_m_ = 0;  // depth of the box
};

}  // namespace simvis
