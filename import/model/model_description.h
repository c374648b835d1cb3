// What a file of a robot or a world says of links, joints, masses, collisions and drives. The readers of all such
// formats fill it; elements of physics use it and do not depend on the format.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/content_pool.h>
#include <simvis/location.h>
#include <simvis/mesh.h>
#include <simvis/node.h>
#include "engine/base/read_fence.h"
#include "scenegraph/collision_mask.h"

namespace simvis {

class ModelMeshes;

struct ModelInertial {
  double mass_kg = 0;
  glm::dmat4 link_from_inertia{1.0};
  glm::dmat3 inertia_kg_m2{0.0};  ///< about the origin of that frame, along its axes
};

/// A shape in the frame of a link.
struct ModelShape {
  enum class Kind { box, sphere, cylinder, capsule, ellipsoid, plane, mesh, surface, nodes } kind = Kind::box;
  glm::dmat4 link_from_shape{1.0};
  glm::dvec3 size{0};  ///< box: edges in m; sphere: the radius in x; cylinder and capsule, along z: the radius
                       ///< in x, in z the length between the ends or half balls; ellipsoid: its half axes; mesh: its
                       ///< scale. A plane is z = 0 without an end, and solid below
  std::filesystem::path file{};           ///< of a mesh
  std::shared_ptr<const Mesh> surface{};  ///< of a surface that no file has
  NodePtr nodes{};                        ///< the group of the kind `nodes`, whose meshes are the surface
};

struct ModelCollision : ModelShape {
  std::optional<double> friction{}, restitution{};  ///< as those of an element `body`; none: the file gives none
  bool larger_friction = false;                     ///< as that of SurfaceProperties
  CollisionMask mask{};
  Location where{};
};

/// A solid of which a link consists where the file gives no inertia.
struct ModelSolid : ModelShape {
  std::optional<double> mass_kg{};
  double density_kg_m3 = 0;  ///< without a mass
  Location where{};
};

/// How a format mends the mass and the principal moments of each link, about its centre of mass.
struct ModelMassBounds {
  double min_mass_kg = 0, min_moment_kg_m2 = 0;
  bool balances_moments = false;    ///< moments of which one is above the sum of the others become their mean
  glm::dvec3 center_of_empty_m{0};  ///< the centre of mass of a link that has neither inertia nor solids
};

struct ModelLink {
  std::string name;
  std::optional<ModelInertial> inertial;
  std::vector<ModelSolid> solids{};              ///< only without `inertial`
  std::optional<ModelMassBounds> mass_bounds{};  ///< none: the mass and the moments stay as they are
  std::vector<ModelCollision> collisions;
  bool is_between_joints = false;  ///< of the format's own several joints of one link: it has neither mass nor surface
  Location where{};
};

/// How a file says that a joint is driven. Positions are those of the joint, efforts N m or N.
struct ModelDrive {
  enum class Kind { effort, position, velocity } kind = Kind::effort;
  /// position: effort = gain * (target - position) - damping * speed; velocity: effort = gain * (target - speed). A
  /// gain below 0 drives away from the target.
  double gain = 0, damping = 0;
  double min_effort = -std::numeric_limits<double>::infinity(), max_effort = std::numeric_limits<double>::infinity();
  double start = 0;                        ///< the target until one is set
  std::optional<double> lower{}, upper{};  ///< of the target
};

/// Angles in radians. A ball turns about all axes of its frame: it has a damping, and a spring that turns it back.
struct ModelJoint {
  enum class Kind { fixed, revolute, continuous, prismatic, ball, floating, planar } kind = Kind::fixed;
  std::string name;
  std::size_t parent = 0, child = 0;  ///< indices of links
  glm::dmat4 parent_from_joint{1.0};
  glm::dvec3 axis{1, 0, 0};                ///< unit length
  std::optional<double> lower{}, upper{};  ///< none: it is open
  double max_effort = 0;                   ///< N m or N; 0: the file gives none
  double max_speed = 0;                    ///< rad/s or m/s; 0: the file gives none
  double damping = 0, friction = 0;        ///< N m s/rad or N s/m; N m or N
  bool damps_new_speed = false;            ///< as that of LinkDesc, for formats whose damping may be large
  double stiffness = 0, rest = 0;          ///< of a spring: N m/rad or N/m, and where it is relaxed, in rad or m
  double rotor_inertia = 0;                ///< kg m^2 or kg, against the acceleration of the joint alone
  std::string leader{};                    ///< of a joint that mimics another
  double multiplier = 1, offset = 0;       ///< position = multiplier * leader + offset, in rad or m
  bool is_coupled = false;                 ///< the leader also follows: the equation is a constraint, no drive
  std::optional<ModelDrive> drive{};       ///< none: no actuator, or the format has none
  Location where{};
};

/// Links and joints as a tree: the first link is the root, every other one is the child of one joint, and joints stand
/// behind those above them.
struct ModelTree {
  std::vector<ModelLink> links;
  std::vector<ModelJoint> joints;
};

/// Links that joints hold together.
struct ModelBody {
  ModelTree model;                 ///< the first link is the one in front of all others, or the file's frame
  glm::dmat4 file_from_root{1.0};  ///< of the first link
  bool is_held = false;            ///< the first link is the file's frame: an anchor without mass
  bool is_static = false;          ///< nothing moves it, nor its joints
  std::string point;               ///< insertion point of the first link; empty: it is the file's frame
  bool has_weight = true;
  std::string carrier{};  ///< the element `pose` that the importer made of a joint which leaves the first link free
  bool stands() const { return is_held || is_static; }  ///< the first link does not move
};

/// Two links, by their names, of the same body or of two.
struct ModelPair {
  std::string a, b;
  bool with_fixed = false;  ///< also all links that fixed joints hold to them; of the same body only
};

/// Which links of a file collide with each other.
struct ModelContacts {
  bool links_collide = false;    ///< with other links of the same body, except for the pairs in `apart`
  std::vector<ModelPair> apart;  ///< links that never collide
};

/// The steps that a file may ask for.
inline constexpr double kMinModelStep_s = 1e-6, kMaxModelStep_s = 0.1;

/// A constraint between two links that is no joint of the tree, as they stand in the file.
struct ModelConstraint {
  enum class Kind { point, fixed } kind = Kind::point;  ///< one point of both, or both as they stand
  std::string a, b;                                     ///< names of links; b empty: the place where a stands at first
  glm::dmat4 a_from_joint{1.0}, b_from_joint{1.0};
  Location where{};
};

struct ModelDescription {
  std::vector<ModelBody> bodies;  ///< in the order of the file
  bool is_world = false;          ///< no single robot or model
  bool has_drives = false;        ///< the format has actuators: a joint without one is not driven
  ModelContacts contacts;
  std::vector<ModelConstraint> constraints;
  std::optional<double> total_mass_kg{};  ///< to which all masses and inertias are scaled; none: they stay
  std::shared_ptr<ModelMeshes> meshes{};  ///< reads the files of shapes; null: no shape has one
  std::vector<std::string> warnings;      ///< what is not taken over, as an importer says it
  Location where{};                       ///< of the world or model, for messages
};

/// What a file says of physics as a whole; empty: it does not.
struct ModelWorld {
  std::optional<glm::dvec3> gravity_m_s2;
  std::optional<double> step_s;
  std::optional<int> iterations;  ///< of its solver
};

/// A file of a robot or a world as its importer has read it. It keeps the file's text, so that the file is read once,
/// and what only physics needs is looked at only if physics asks; files that it names must lie in the folders
/// allowed for the part.
/// Threads   one thread at a time.
class ModelSource {
 public:
  ModelSource() : scope_(read_scope()) {}
  virtual ~ModelSource() = default;
  /// Made by the first call. Throws InputError with the place for what physics cannot use: a number that is none; a
  /// mass, size, damping or friction that is negative; a mesh that is missing; and what each reader says.
  const ModelDescription& description(ContentPool& pool) {
    std::optional<ReadFence> fence;
    if (scope_) fence.emplace(*scope_);
    if (!description_) description_ = describe(pool);
    return *description_;
  }
  /// Throws InputError with the place: the format or the file has none; a step that is too short or too long.
  virtual ModelWorld world() = 0;
  /// The file as URDF, with xacro expanded; empty for other formats.
  virtual std::string_view urdf() const { return {}; }
  /// The mesh files that urdf() names for its visuals and that were read, by these names.
  const std::map<std::string, std::filesystem::path>& visual_files() const { return visual_files_; }
  void set_visual_files(std::map<std::string, std::filesystem::path> files) { visual_files_ = std::move(files); }

 private:
  virtual ModelDescription describe(ContentPool& pool) = 0;
  std::optional<ReadScope> scope_;  // whose files the part may name
  std::optional<ModelDescription> description_;
  std::map<std::string, std::filesystem::path> visual_files_;
};

}  // namespace simvis
