// A URDF robot: its links as a tree, with what is seen of them and the joints between them.
//
// Robots are read as programs of robots read them. With a warning:
//   commas between the numbers of vectors: spaces
//   a mesh whose scale is one number: the same for all axes
//   visuals without a geometry that is known, and boxes, cylinders, capsules, spheres and meshes of size 0: left out
//   <mimic> of a fixed joint, or of a leader that does not exist: ignored
//   a lower limit above the upper one, and no limits at all: the joint is open
//   a material that is defined twice: the first definition counts
//   a material that is defined nowhere: grey
//   a colour of three numbers: opaque; one that is no numbers from 0 to 1: grey
//   a joint of the type spherical, which only Bullet knows: a ball joint
//   a robot without a name: "robot"
// What SimVis shows does not need masses, collisions, dynamics, effort and velocity: urdf_dynamics.h reads them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <simvis/part_importer.h>
#include "import/model/model_description.h"
#include "import/model/package_files.h"
#include "import/urdf/urdf_element.h"
#include "import/urdf/urdf_looks.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {

struct UrdfLink {
  std::string name;
  UrdfElement element;
  std::vector<UrdfVisual> visuals;
};

/// A joint of a type that does not turn or slide has no limits. One that is continuous, or has no limits that hold, is
/// open. Dynamics are 0.
struct UrdfJoint {
  ModelJoint model;
  UrdfElement element;
};

/// Numbers are finite, names are different and not blank.
struct UrdfFile {
  std::shared_ptr<const XmlText> text;
  std::string name;
  std::vector<UrdfLink> links;  ///< the root, then each behind the one above it, children by the names of their joints
  std::vector<UrdfJoint> joints;  ///< joints[i] leads to links[i + 1]
  std::vector<std::string> warnings;
};

/// The robot's text, without zero bytes at its end, expanded if it is a xacro file. What is read otherwise than written
/// gives a warning. Throws InputError as expand_xacro(), and for arguments of a file that is no xacro.
XmlText read_urdf_text(const ImportRequest& request, PackageFiles& packages, std::vector<std::string>& warnings);

/// Throws InputError with the place for links or joints that break the format, an axis of zero length, a mimic of
/// itself in a ring or of a joint that does not turn or slide, no root link or several, and cycles.
UrdfFile read_urdf(XmlText text);

}  // namespace simvis
