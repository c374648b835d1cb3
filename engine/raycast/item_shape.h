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
std::optional<SeenShape> shape_of_item(const DrawList& list, std::uint32_t item, const glm::dmat4& world_from_sensor);

}  // namespace simvis
