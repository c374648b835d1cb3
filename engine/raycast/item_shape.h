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
/// For a cloud, the shape is a sphere or a disc around the origin, which face_of_hit() moves to the point that was hit.
std::optional<SeenShape> shape_of_item(const DrawList& list, std::uint32_t item, const glm::dmat4& world_from_sensor);

/// The face of the shape that a hit with this primitive is on. For a cloud, the primitive is the number of a point, and
/// the shape is moved to this point.
std::uint32_t face_of_hit(SeenShape& shape, const Mesh& mesh, std::uint32_t primitive);

/// Moves the shape of a cloud, in the frame of its mesh, to one of its points.
inline void set_point(SeenShape& shape, const Mesh& cloud, std::uint32_t primitive) {
  const std::uint32_t vertex = cloud.indices[primitive];
  shape.middle = in_shape(*shape.shape, glm::dvec3(cloud.positions[vertex]));
  if (shape.shape->kind != SurfaceKind::disc) return;  // attributes of spheres are not read: they are far apart
  shape.normal = in_shape(*shape.shape, glm::dvec3(cloud.attributes[vertex].normal));
}

}  // namespace simvis
