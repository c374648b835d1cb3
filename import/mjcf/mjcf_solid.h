// The solid shapes of MJCF's geoms.
#pragma once

#include <string>

#include "import/mjcf/mjcf_element.h"
#include "import/model/model_description.h"

namespace simvis {

/// Sets the kind and the size of a sphere, capsule, cylinder, box or ellipsoid. Throws InputError for another type, and
/// for sizes that are missing or not above 0.
void read_mjcf_solid(const MjcfElement& geom, const std::string& type, ModelShape& shape);

}  // namespace simvis
