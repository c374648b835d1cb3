// A robot or model of a file as a body with joints.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/scene.h>
#include "dynamics/part_shapes.h"
#include "dynamics/world.h"
#include "import/urdf/urdf_dynamics.h"

namespace simvis {

/// A joint that moves, with the link that it moves in ArticulationDesc::links.
struct RobotJoint {
  UrdfMovingJoint urdf;
  std::size_t link = 0;
  std::optional<std::size_t> leader;  ///< index of the joint that it mimics
};

/// The surface of an element's bodies, and whether it counts also where the file gives one.
struct RobotSurface {
  SurfaceProperties surface;
  bool friction_counts = false, restitution_counts = false;
};

struct RobotDescription {
  ArticulationDesc body;           ///< without places and positions at the start
  std::vector<RobotJoint> joints;  ///< in the order of the file's tree
  struct NamedLink {
    std::string name;
    int link = -1;  ///< in ArticulationDesc::links; -1: the base
  };
  std::vector<NamedLink> links;  ///< of the file
  struct KeptJoint {
    std::string name;
    std::size_t link = 0;  ///< in ArticulationDesc::links
  };
  std::vector<KeptJoint> kept_joints;
  bool has_weight = true;  ///< of a body without joints that move
};

/// The triangles of collision meshes. Each file is read once.
class CollisionMeshes {
 public:
  explicit CollisionMeshes(ContentPool& pool) : pool_(pool) {}
  /// Throws InputError for a file that is broken.
  const Triangles& read(const std::filesystem::path& file);

 private:
  ContentPool& pool_;
  std::map<std::filesystem::path, Triangles> read_;
};

/// How meshes collide: as their convex hulls, or as they are, which nothing that moves may do.
enum class MeshCollision { hull, triangles };

/// The attributes friction and restitution; they count if the command has them.
RobotSurface read_robot_surface(const ElementContext& context);

/// How a file becomes a robot.
struct RobotOptions {
  RobotSurface surface;
  MeshCollision collision = MeshCollision::hull;
  std::vector<std::string> kept_joints{};  ///< fixed joints that stay joints, so that their loads can be measured
};

/// Links behind other fixed joints become part of the link in front.
/// Throws InputError with the place in the file: a link that a joint moves, or a kept one holds, and that has no mass
/// or an inertia that no body has, a planar or floating joint, a mesh that is broken or flat.
RobotDescription describe_robot(const UrdfDynamics& urdf, const RobotOptions& options, CollisionMeshes& meshes);

}  // namespace simvis
