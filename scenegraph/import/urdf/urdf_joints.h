// The joints of a URDF robot as element commands.
#pragma once

#include <string>
#include <vector>

#include "scenegraph/import/urdf/urdf_file.h"

namespace simvis {

/// One command per degree of freedom, parents before children, mimics after all others. Each is inserted at the child
/// link's insertion point, and so moves the link and all below it.
///
/// revolute, continuous, prismatic  an element `joint` of the joint's name; continuous without limits
/// floating                         an element `pose`
/// planar                           two prismatic joints, NAME_X and NAME_Y, and a revolute one, NAME_TURN, about the
///                                  axis; X is the frame's x axis brought into the plane (y where the axis is near x)
/// mimic                            an element `mimic_joint`; the limits of its own are not applied
/// fixed                            none
///
/// Radians become degrees. A value starts at 0, or at the limit nearest to it.
/// Throws InputError at the joint: an axis of zero length, limits upside down, a mimic of a joint that does not exist,
/// cannot be followed or follows in a ring, names that elements cannot have.
std::vector<std::string> urdf_joint_commands(const UrdfFile& file);

}  // namespace simvis
