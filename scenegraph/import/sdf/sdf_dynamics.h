// What an SDF file with one model says of masses, collisions and joints.
#pragma once

#include <string>
#include <vector>

#include <simvis/part_importer.h>
#include "scenegraph/import/urdf/urdf_dynamics.h"

namespace simvis {

struct SdfDynamics {
  /// As of a URDF file. The first link is the model itself; a link has the name of its insertion point, and a joint
  /// that of its element. In front of a link that moves stands one without mass, in the frame of the joint.
  UrdfDynamics model;
  std::vector<std::string> warnings;  ///< what is not taken over, as an importer tells it
};

/// Reads the file as the importer does. A link without <inertial> has what SDF gives it: 1 kg and 1 kg m^2, with a
/// warning.
/// Throws InputError with the place: as the importer; the file is a world or has several models; several links are not
/// joined; a joint of a type other than fixed, revolute, continuous, hinge and prismatic; a mass, size or damping that
/// is negative or infinite; a mesh that is missing.
SdfDynamics read_sdf_dynamics(const ImportRequest& request);

}  // namespace simvis
