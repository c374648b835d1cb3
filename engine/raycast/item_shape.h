// The exact shape of an item as a sensor sees it.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include <simvis/draw_list.h>
#include "engine/raycast/ray_surface.h"

namespace simvis {

/// The shape that rays meet in place of the triangles of an item; empty if there is none. It refers to the item's mesh.
/// `world_from_sensor` is rigid.
///
/// Of a cloud it is the sphere around the origin: face_of_hit() moves it to the point that was hit.
std::optional<SeenShape> shape_of_item(const DrawList& list, std::uint32_t item, const glm::dmat4& world_from_sensor);

/// The face of the shape that a hit with this primitive is on. Of a cloud the shape becomes the sphere around the point
/// that the primitive is.
std::uint32_t face_of_hit(SeenShape& shape, const Mesh& mesh, std::uint32_t primitive);

/// A point of a cloud, in the frame of its mesh.
inline glm::dvec3 point_of(const Mesh& cloud, std::uint32_t primitive) {
  return glm::dvec3(cloud.positions[cloud.indices[primitive]]);
}

}  // namespace simvis
