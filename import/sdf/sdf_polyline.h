// The solid of an SDF <polyline>.
#pragma once

#include <simvis/mesh.h>
#include "import/sdf/sdf_element.h"

namespace simvis {

/// The polygon of the <point>s, from z = 0 to <height>, with flat normals; its last point may repeat the first. Throws
/// InputError for fewer than three points, a side without length, sides that cross, and a height that is not above 0.
Mesh sdf_polyline_mesh(const SdfElement& polyline);

}  // namespace simvis
