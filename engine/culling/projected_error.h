// How large an error of a mesh's surface appears in a view: what decides which level of a mesh is drawn.
#pragma once

#include <glm/glm.hpp>

#include <simvis/frame_plan.h>
#include "engine/geometry/view_projection.h"

namespace simvis {

/// An upper bound, in pixels of the view, on the distance at which the view shows two points that are
/// `error_m` apart in the mesh's frame, one of them within the box and the view. Infinite if the other may reach the
/// near plane.
///
/// `box` is that of the mesh with the transform `world_from_mesh`, which may scale its axes.
double projected_error_px(const View& view, const ViewProjection& projection, const WorldBox& box,
                          const glm::dmat4& world_from_mesh, double error_m);

}  // namespace simvis
