// Whether a point lies inside a closed surface.
#pragma once

#include <glm/glm.hpp>

#include <simvis/mesh.h>
#include "engine/base/program_api.h"

namespace simvis {

/// Whether the point lies inside the solid that the triangles of a mesh bound from outside, by its winding number.
/// False for meshes of points or lines, for open surfaces seen from their hollow side at less than three quarters of
/// all directions, and where the whole box of the mesh lies within `near_m` of the point.
bool is_inside_solid(const Mesh& mesh, const glm::dmat4& world_from_mesh, const glm::dvec3& world_m, double near_m);

/// Whether depth images and lasers see the material, by its opacity and base colour alone; null: the default material.
SIMVIS_PROGRAM_API bool is_depth_visible(const Material* material);

}  // namespace simvis
