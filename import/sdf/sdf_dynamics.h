// What an SDF file says of masses, collisions and joints, and a world of gravity and steps.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <simvis/part_importer.h>
#include "import/urdf/urdf_dynamics.h"

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

/// Links that joints hold together; those of a static model do not move.
struct SdfBody {
  UrdfDynamics model;   ///< the first link is the one in front of all others, or the file's frame
  bool stands = false;  ///< the first link does not move
  std::string point;    ///< insertion point of the first link; empty: it is the file's frame
  bool has_weight = true;
};

struct SdfBodies {
  std::vector<SdfBody> bodies;  ///< in the order of the file
  std::vector<std::string> warnings;
};

/// Reads all models of a file as bodies. A collision that is wrong is left out with a warning, as the importer does
/// with a visual. Throws InputError as read_sdf_dynamics(), except about worlds, separate links and collisions.
SdfBodies read_sdf_bodies(const ImportRequest& request);

/// What a world says of physics; empty: it does not.
struct SdfPhysics {
  std::optional<glm::dvec3> gravity_m_s2;
  std::optional<double> step_s;
  std::optional<int> iterations;  ///< of ODE's solver
};
inline constexpr double kMinSdfStep_s = 1e-6, kMaxSdfStep_s = 0.1;

/// Throws InputError with the place: as the importer, no world, a step that is too short or too long.
SdfPhysics read_sdf_physics(const ImportRequest& request);

}  // namespace simvis
