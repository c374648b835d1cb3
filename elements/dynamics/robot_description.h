// A URDF robot as a body with joints.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <simvis/scene.h>
#include "dynamics/world.h"
#include "scenegraph/import/urdf/urdf_dynamics.h"

namespace simvis {

/// A joint that moves, with the link that it moves in ArticulationDesc::links.
struct RobotJoint {
  UrdfMovingJoint urdf;
  std::size_t link = 0;
  std::optional<std::size_t> leader;  ///< index of the joint that it mimics
};

struct RobotDescription {
  ArticulationDesc body;           ///< without places and positions at the start
  std::vector<RobotJoint> joints;  ///< in the order of the file's tree
  struct NamedLink {
    std::string name;
    int link = -1;  ///< in ArticulationDesc::links; -1: the base
  };
  std::vector<NamedLink> links;  ///< of the file
};

/// Links behind fixed joints become part of the link in front. A mesh collides as its convex hull.
/// Throws InputError with the place in the URDF: a link that a joint moves and that has no mass or an inertia that no
/// body has, a planar or floating joint, a mesh that is broken or flat.
RobotDescription describe_robot(const UrdfDynamics& urdf, ContentPool& pool);

}  // namespace simvis
