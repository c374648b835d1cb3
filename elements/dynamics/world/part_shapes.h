// Collision shapes from the meshes of a part.
#pragma once

#include <cstdint>
#include <vector>

#include <simvis/node.h>
#include "elements/dynamics/world/world.h"

namespace simvis {

/// Triangles in one frame; the same point may occur several times.
struct Triangles {
  std::vector<glm::dvec3> points;
  std::vector<std::uint32_t> indices;  ///< three each
};

/// The triangles of everything that a graph draws, in the frame of its root.
Triangles triangles_of(const Group& root);

/// Shapes around the triangles' box, whose middle is theirs: all edges of the box; a sphere over its longest edge; a
/// capsule or cylinder along z over its height and the longer of the two other edges. There is at least one point.
CollisionShape fitted(CollisionKind kind, const Triangles& triangles);

/// The triangles themselves.
CollisionShape mesh_of(const Triangles& triangles);

/// Whether triangles bound a solid: of each edge as many run one way as the other. Corners at the same place are one.
bool is_closed(const Triangles& triangles);

/// Divides triangles into pieces without a common corner. Corners at the same place are one.
std::vector<Triangles> connected_pieces(const Triangles& triangles);

}  // namespace simvis
