// What the joints of a URDF robot are.
#pragma once

#include <map>
#include <string>

#include "import/model/model_description.h"
#include "import/urdf/urdf_file.h"

namespace simvis {

/// The joints of a robot by their names: kinds, places, axes, limits and leaders, without links and dynamics. A joint
/// that is continuous, or has no limits that hold, is open.
/// Throws InputError at the joint for an axis of zero length, for an unknown type, and for a mimic of a joint that
/// cannot be followed or of itself in a ring.
std::map<std::string, ModelJoint> read_urdf_joints(const UrdfFile& file);

}  // namespace simvis
