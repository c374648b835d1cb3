// Turns the joints of a URDF robot into element commands.
#pragma once

#include <string>
#include <vector>

#include "import/urdf/urdf_file.h"

namespace simvis {

/// Returns one command per degree of freedom, parents before children, mimic joints after all others. Each element is
/// inserted at the child link's insertion point, so that it moves the link and everything below it.
///
/// revolute, continuous, prismatic  an element `joint` with the joint's name; a continuous joint has no limits
/// floating                         an element `pose`
/// planar                           two prismatic joints, NAME_X and NAME_Y, and a revolute one, NAME_TURN, about the
///                                  axis; X is the frame's x axis projected into the plane (y if the axis is near x)
/// mimic                            an element `mimic_joint`; the limits of the mimic joint itself are not applied
/// fixed                            no command
///
/// Radians become degrees. A value starts at 0, or at the limit nearest to 0.
/// Throws InputError at the joint for an axis of zero length, and for a mimic of a joint that cannot be followed or of
/// itself in a ring.
std::vector<std::string> urdf_joint_commands(const UrdfFile& file);

}  // namespace simvis
