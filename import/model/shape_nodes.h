// What is seen of the shapes of robots and worlds.
#pragma once

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "import/model/model_description.h"

namespace simvis {

/// Adds the node of a box, a sphere, a cylinder, a capsule, an ellipsoid, which is a stretched sphere, or a surface, in
/// the frame of the shape. Rays meet the round ones as such.
void add_shape_nodes(const ModelShape& shape, ContentPool& pool, Group& group);

}  // namespace simvis
