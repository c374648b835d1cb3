// The exact shapes behind the triangles that Coin generates for spheres, cylinders and cones.
#pragma once

#include <Inventor/nodes/SoShape.h>

#include <optional>

#include <simvis/mesh.h>

namespace simvis {

/// The closed round shape that a node describes; empty for other nodes, for a shape without all of its parts, and for
/// sizes that are not above 0. `mesh` holds the triangles of the node, which say how far they deviate from it.
std::optional<ExactSurface> round_shape_of(const SoShape& node, const Mesh& mesh);

}  // namespace simvis
