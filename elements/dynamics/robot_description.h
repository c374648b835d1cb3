// A robot or model of a file as a body with joints.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/element.h>
#include <simvis/scene.h>
#include "elements/dynamics/shapes_of_model.h"
#include "elements/dynamics/world/world.h"
#include "import/model/model_description.h"

namespace simvis {

/// A joint that moves, with the link that it moves in ArticulationDesc::links.
struct RobotJoint {
  ModelJoint model;
  std::size_t link = 0;
  std::optional<std::size_t> leader;  ///< index of the joint that it mimics
};

/// The surface of an element's bodies, and whether it counts also where the file gives one.
struct RobotSurface {
  SurfaceProperties surface;
  bool friction_counts = false, restitution_counts = false, mask_counts = false;
};

struct RobotDescription {
  ArticulationDesc body;           ///< without places and positions at the start
  std::vector<RobotJoint> joints;  ///< in the order of the file's tree
  struct NamedLink {
    std::string name;
    int link = -1;                   ///< in ArticulationDesc::links; -1: the base
    glm::dmat4 link_from_part{1.0};  ///< from the link of the file to that one
  };
  std::vector<NamedLink> links;  ///< of the file
  struct KeptJoint {
    std::string name;
    std::size_t link = 0;  ///< in ArticulationDesc::links
  };
  std::vector<KeptJoint> kept_joints;
  bool has_weight = true;   ///< of a body without joints that move
  bool has_drives = false;  ///< the file says which joints are driven, and how
};

/// The attributes of surface_rows(); they count if the command has them.
RobotSurface read_robot_surface(const ElementContext& context);

/// How a file becomes a robot.
struct RobotOptions {
  RobotSurface surface;
  MeshCollision collision = MeshCollision::hull;
  std::vector<std::string> kept_joints{};  ///< fixed joints that stay joints, so that their loads can be measured
  bool is_static = false;                  ///< no joint moves
  bool base_moves = false;                 ///< by forces
};

/// A tree of a file's links as one body. Links behind fixed joints that are not kept become part of the link in front.
/// Links that move have a possible inertia, see correct_inertia(); warnings go to the scene. Throws InputError with the
/// place in the file: a link that moves, or that a kept joint holds, and that has no mass, a planar or floating joint,
/// a mesh that is broken or flat.
RobotDescription describe_robot(Scene& scene, const ModelTree& model, const RobotOptions& options,
                                CollisionMeshes& meshes);

/// Scales the masses and the inertias of bodies so that all together weigh so much. Bodies without mass stay as they
/// are.
void set_total_mass(std::span<RobotDescription> bodies, double mass_kg);

/// Which links of a file collide with each other. The file decides; with an attribute `srdf` all links collide, except
/// for the pairs that the SRDF file disables and those that the model's file excludes. Throws InputError at the
/// attribute or the place in the SRDF file, see srdf_file.h.
ModelContacts read_link_contacts(const ElementContext& context, const ModelDescription& file);

/// Lets links of a body collide with each other where `contacts` says so, by the names of links in `description`. The
/// index of a link there is the number of its part in the body, see WorldPart.
void set_link_contacts(const ModelContacts& contacts, RobotDescription& description);

/// The attribute `srdf` of elements that read robots.
inline constexpr AttributeSpec kSrdfRow{
    .name = "srdf",
    .kind = AttributeKind::file,
    .text =
        "SRDF file beside a URDF file: links of the robot collide with each other, except for a link and its parent "
        "and the pairs that the file disables"};

}  // namespace simvis
